// manifest.json of a session; what is accepted is written and read again the same.
#include "backend/session/manifest.hpp"

#include "tests/fuzz/fuzz_target.hpp"
#include "tests/fuzz/scratch_folder.hpp"

GROUNDLOOP_FUZZ_TARGET(manifest) {
  const SessionFolder folder(lay_out("manifest", {{"manifest.json", text_of(input)}}));
  FUZZ_PROMISE(has_manifest(folder));
  (void)is_session(folder);
  const Manifest manifest = read_manifest(folder);
  for (const ManifestPart& part : manifest.parts) check_part_name(part.name, "session");
  write_manifest(folder, manifest);
  const Manifest again = read_manifest(folder);
  FUZZ_PROMISE(again.identity == manifest.identity && again.checksums == manifest.checksums);
  FUZZ_PROMISE(again.parts.size() == manifest.parts.size());
  (void)read_complete_manifest(folder);
}
