// Any bytes as a packet of each family, and as messages that hold packets or Livox points: what a
// decoder accepts it decodes within its bytes. A byte chooses, the rest is the packet.
#include "frontend/recordings/livox_message.hpp"
#include "frontend/recordings/packets/packet_decoder.hpp"
#include "tests/fuzz/fuzz_target.hpp"

namespace groundloop::fuzz {
namespace {

void use_decoder(const recordings::PacketDecoder& decoder, Input packet) {
  if (!decoder.accepts(packet)) return;
  recordings::PacketPoints points;
  for (std::size_t block = 0; block < decoder.blocks(); ++block) {
    const double phase = decoder.phase(packet, block);
    FUZZ_PROMISE(phase >= 0.0 && phase < 1.0);
    (void)decoder.block_time(packet, block);
    decoder.decode(packet, block, block + 1, points);
  }
  (void)decoder.clock(packet);
  FUZZ_PROMISE(points.times.size() == points.points.size());
  FUZZ_PROMISE(points.attributes.ring.size() == points.points.size());
  for (const Eigen::Vector3f& p : points.points) FUZZ_PROMISE(p.allFinite());
}

}  // namespace
}  // namespace groundloop::fuzz

GROUNDLOOP_FUZZ_TARGET(packets) {
  Chooser chooser(input);
  const auto which = chooser.get<std::uint8_t>();
  const recordings::DecoderSource source{chooser.rest(), "", "", "input"};
  if (which % 4 == 0) {
    if (const auto decoder = recordings::make_velodyne_decoder(source))
      use_decoder(*decoder, chooser.rest());
  } else if (which % 4 == 1) {
    if (const auto decoder = recordings::make_hesai_decoder(source))
      use_decoder(*decoder, chooser.rest());
  } else {
    const auto encoding = which % 4 == 2 ? recordings::Encoding::ros1 : recordings::Encoding::cdr;
    (void)recordings::parse_livox(chooser.rest(), encoding, "input");
  }
}
