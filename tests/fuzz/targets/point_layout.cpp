// Any description of point records over any bytes: fields of all types at all places, times in all
// units. A byte for the number of fields, seven bytes a field, the stamp, then the points.
#include "tests/fuzz/fuzz_target.hpp"
#include "tests/fuzz/targets/point_files.hpp"

GROUNDLOOP_FUZZ_TARGET(point_layout) {
  constexpr const char* kNames[] = {"x", "y", "z", "t", "time", "timestamp", "offset_time", "ring"};
  Chooser chooser(input);
  recordings::PointLayout layout;
  const auto bits = chooser.get<std::uint8_t>();
  layout.big_endian = (bits & 0x80U) != 0;
  for (unsigned i = 0; i < (bits & 0x0fU); ++i) {
    recordings::PointField field;
    field.name = kNames[chooser.get<std::uint8_t>() % std::size(kNames)];
    field.type = static_cast<recordings::FieldType>(chooser.get<std::uint8_t>() % 10U);
    field.offset = chooser.get<std::uint16_t>();
    field.stride = chooser.get<std::uint16_t>();
    layout.fields.push_back(field);
  }
  const auto stamp = chooser.get<Nanoseconds>();
  const std::size_t count = chooser.get<std::uint16_t>();
  if (!is_stamp(stamp)) return;  // readers let none of these through
  decode_table(layout, chooser.rest(), count, stamp);
}
