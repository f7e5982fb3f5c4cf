// Raw packets: decoded to where the manuals' formulas put each shot, cut into turns, from bags and
// captures; what is broken or missing is answered. Everything is built by hand after the manuals.
#include <cmath>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "frontend/core/error.hpp"
#include "frontend/recordings/packets/packet_decoder.hpp"
#include "frontend/recordings/recording.hpp"
#include "tests/support/bag_bytes.hpp"
#include "tests/support/packet_bytes.hpp"
#include "tests/support/temporary_folder.hpp"

namespace groundloop {
namespace {

using recordings::DecoderSource;
using recordings::PacketPoints;
using testing::Bytes;
using testing::bytes_of;
using ::testing::Contains;
using ::testing::HasSubstr;
using testing::StampedPacket;
using testing::VelodynePacket;
using testing::write_file;

constexpr double kDegree = std::numbers::pi / 180.0;

PacketPoints decode(const recordings::PacketDecoder& decoder, const std::string& packet) {
  PacketPoints points;
  decoder.decode(bytes_of(packet), 0, decoder.blocks(), points);
  return points;
}

std::unique_ptr<recordings::PacketDecoder> velodyne(const std::string& packet) {
  return recordings::make_velodyne_decoder({bytes_of(packet), "", "", "test"});
}

// Azimuth clockwise from ahead (deg), elevation (deg), range: as Velodyne's manual has it, with x
// ahead and y to the left.
void expect_at(const Eigen::Vector3f& p, double azimuth, double elevation, double range) {
  const double flat = range * std::cos(elevation * kDegree);
  EXPECT_NEAR(p.x(), flat * std::cos(azimuth * kDegree), 2e-5 * range);
  EXPECT_NEAR(p.y(), -flat * std::sin(azimuth * kDegree), 2e-5 * range);
  EXPECT_NEAR(p.z(), range * std::sin(elevation * kDegree), 2e-5 * range);
}

VelodynePacket turning(std::uint8_t model, std::uint16_t first, std::uint16_t step,
                       std::size_t together) {
  VelodynePacket packet;
  packet.model = model;
  for (std::size_t block = 0; block < 12; ++block)
    packet.azimuths[block] =
        static_cast<std::uint16_t>((first + step * (block / together)) % 36000U);
  return packet;
}

TEST(VelodynePackets, Vlp16ShotsHaveTheAzimuthAndTimeOfTheirOwn) {
  VelodynePacket packet = turning(0x22, 9000, 40, 1);
  packet.echoes[{0, 0}] = {5000, 77};     // laser 0 (-15 degrees), at the block's own azimuth
  packet.echoes[{2, 21}] = {2000, 1};     // second firing, laser 5 (+5)
  packet.echoes[{11, 31}] = {2500, 255};  // the last block turns on as the one before (laser 15)
  const auto decoder = velodyne(packet.bytes());
  EXPECT_EQ(decoder->sensor(), "Velodyne VLP-16, 16 beams, one return");
  const PacketPoints points = decode(*decoder, packet.bytes());
  ASSERT_EQ(points.points.size(), 3U);
  expect_at(points.points[0], 90.0, -15.0, 10.0);
  expect_at(points.points[1], 90.8 + 0.4 * (55.296 + 5 * 2.304) / 110.592, 5.0, 4.0);
  expect_at(points.points[2], 94.4 + 0.4 * (55.296 + 15 * 2.304) / 110.592, 15.0, 5.0);
  EXPECT_EQ(points.times[0], 0);
  EXPECT_EQ(points.times[1], std::llround(1e3 * (2 * 110.592 + 55.296 + 5 * 2.304)));
  EXPECT_THAT(points.attributes.intensity, ::testing::ElementsAre(77.0F, 1.0F, 255.0F));
  EXPECT_THAT(points.attributes.ring, ::testing::ElementsAre(0, 10, 15));
}

TEST(VelodynePackets, DualReturnsAreNumberedByRangeAndKeptOnceWhereTheyAreOne) {
  VelodynePacket packet = turning(0x22, 0, 40, 2);
  packet.mode = 0x39;
  packet.echoes[{0, 0}] = {5000, 10};  // last
  packet.echoes[{1, 0}] = {2000, 20};  // strongest
  packet.echoes[{2, 0}] = {3000, 30};  // one return, sent twice
  packet.echoes[{3, 0}] = {3000, 30};
  const PacketPoints points = decode(*velodyne(packet.bytes()), packet.bytes());
  ASSERT_EQ(points.points.size(), 3U);
  EXPECT_THAT(points.attributes.return_number, ::testing::ElementsAre(2, 1, 1));
  EXPECT_EQ(points.times[2], 110'592);
  expect_at(points.points[2], 0.4, -15.0, 6.0);
}

TEST(VelodynePackets, BeamsOfEachModelAreTheManuals) {
  VelodynePacket hdl32 = turning(0x21, 0, 17, 1);
  hdl32.echoes[{1, 31}] = {5000, 0};
  const PacketPoints a = decode(*velodyne(hdl32.bytes()), hdl32.bytes());
  expect_at(a.points.at(0), 0.17 + 0.17 * 31 * 1.152 / 46.08, 32.0 / 3.0, 10.0);

  VelodynePacket vlp32 = turning(0x28, 0, 20, 1);
  vlp32.echoes[{0, 3}] = {2500, 0};  // fires with laser 2; azimuth offset -1.4 degrees
  const PacketPoints b = decode(*velodyne(vlp32.bytes()), vlp32.bytes());
  expect_at(b.points.at(0), -1.4 + 0.2 * 2.304 / 55.296, -15.639, 10.0);
  EXPECT_EQ(b.times[0], 2304);

  VelodynePacket vls128 = turning(0xa1, 18000, 20, 4);
  for (std::size_t block = 0; block < 12; ++block)
    vls128.banks[block] = static_cast<std::uint16_t>(0xeeff - 0x1100 * (block % 4));
  vls128.echoes[{7, 31}] = {2500, 0};  // laser 127 in the second cycle: group 15, after the pause
  const PacketPoints c = decode(*velodyne(vls128.bytes()), vls128.bytes());
  expect_at(c.points.at(0), 180.2 - 6.354 + 0.2 * 16 * 2.665 / 53.3, 0.43, 10.0);
  EXPECT_EQ(c.times[0], std::llround(1e3 * (53.3 + 16 * 2.665 - 8.7)));
}

TEST(VelodynePackets, Hdl64IsRefusedWithARemedy) {
  VelodynePacket packet;
  packet.model = 0x46;
  for (std::size_t block = 1; block < 12; block += 2) packet.banks[block] = 0xddff;
  try {
    (void)velodyne(packet.bytes());
    FAIL();
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), HasSubstr("HDL-64E are not decoded; convert"));
  }
}

// A PandarXT-32 packet whose blocks are 0.18 degrees apart; laser 4 of block 3 sees 5 m.
std::string xt32_packet(std::uint8_t mode, std::uint8_t lasers = 32) {
  Bytes out;
  for (const int byte : {0xee, 0xff, 6, 1, 0, 0}) out.put(static_cast<std::uint8_t>(byte));
  out.put(lasers).put<std::uint8_t>(8).put<std::uint8_t>(1).put<std::uint8_t>(4);
  out.put<std::uint8_t>(1).put<std::uint8_t>(1);
  for (int block = 0; block < 8; ++block) {
    out.put(static_cast<std::uint16_t>(9000 + 18 * block));
    for (int laser = 0; laser < 32; ++laser) {
      const bool hit = block == 3 && laser == 4;
      out.put<std::uint16_t>(hit ? 1250 : 0).put<std::uint8_t>(hit ? 42 : 0);
      out.put<std::uint8_t>(255);
    }
  }
  out.text(std::string(10, '\0')).put(mode).put<std::uint16_t>(600);
  for (const int byte : {121, 11, 25, 9, 30, 15}) out.put(static_cast<std::uint8_t>(byte));
  out.put<std::uint32_t>(250'000).put<std::uint8_t>(0x42).put<std::uint32_t>(7);
  return out.str();
}

TEST(HesaiPackets, Xt32IsDecodedWithItsDate) {
  const std::string packet = xt32_packet(0x37);
  const auto decoder = recordings::make_hesai_decoder({bytes_of(packet), "", "", "test"});
  ASSERT_TRUE(decoder);
  EXPECT_EQ(decoder->sensor(), "Hesai PandarXT-32, 32 beams, one return");
  // 2021-11-25 09:30:15.25 UTC, by `date -d`.
  EXPECT_EQ(decoder->clock(bytes_of(packet)), 1'637'832'615'250'000'000);
  const PacketPoints points = decode(*decoder, packet);
  ASSERT_EQ(points.points.size(), 1U);
  // Hesai: y at azimuth 0, x at 90 degrees; laser 4 of 15 to -16 degrees is at 11.
  const double flat = 5.0 * std::cos(11 * kDegree), azimuth = 90.54 * kDegree;
  EXPECT_NEAR(points.points[0].x(), flat * std::sin(azimuth), 1e-5);
  EXPECT_NEAR(points.points[0].y(), flat * std::cos(azimuth), 1e-5);
  EXPECT_NEAR(points.points[0].z(), 5.0 * std::sin(11 * kDegree), 1e-5);
  EXPECT_EQ(points.times[0], 5'632 - 50'000 * 4 + 368 + 1'512 * 4);
  EXPECT_THAT(points.attributes.reflectivity, ::testing::ElementsAre(42.0F));
  EXPECT_THAT(points.attributes.ring, ::testing::ElementsAre(27));
}

TEST(HesaiPackets, OtherModelsAndMissingCalibrationsAreAnswered) {
  const auto error = [](const std::string& packet, const std::string& calibration) {
    try {
      (void)recordings::make_hesai_decoder({bytes_of(packet), calibration, "", "test"});
    } catch (const InputError& e) {
      return std::string(e.what());
    }
    return std::string("none");
  };
  EXPECT_THAT(error(xt32_packet(0x37, 128), ""), HasSubstr("with 128 lasers (protocol 6.1"));
  std::string pandar40(1262, '\0');
  pandar40[0] = '\xff';
  pandar40[1] = '\xee';
  EXPECT_THAT(error(pandar40, ""), HasSubstr("--calibration FILE.csv"));
  testing::TemporaryFolder folder;
  write_file(folder / "c.csv", "Channel,Elevation,Azimuth\n1,15.0,0.1\n2,14.0,0.1\n");
  EXPECT_THAT(error(xt32_packet(0x37), (folder / "c.csv").string()),
              HasSubstr("calibrates 2 lasers, the recorded sensor has 32"));
  write_file(folder / "c.csv", "1,15.0,0.1\n3,14.0,0.1\n");
  EXPECT_THAT(error(xt32_packet(0x37), (folder / "c.csv").string()),
              HasSubstr("c.csv:2: expected"));
}

// Two beams at +10 and -20 degrees, eight columns a turn, two a packet.
std::string ouster_json(const std::string& profile) {
  return R"({"prod_line": "OS-1-2", "beam_altitude_angles": [10, -20],
    "beam_azimuth_angles": [3, -3], "lidar_origin_to_beam_origin_mm": 15.8,
    "lidar_to_sensor_transform": [-1,0,0,0, 0,-1,0,0, 0,0,1,36.18, 0,0,0,1],
    "data_format": {"columns_per_frame": 8, "columns_per_packet": 2, "pixels_per_column": 2,
    "udp_profile_lidar": ")" +
         profile + "\"}}";
}

// Column 2 of 8 sees 10.24 m at the upper beam; in dual profiles also 20.48 m.
std::string ouster_packet(const std::string& profile, std::uint16_t first_column = 2,
                          bool valid = true, std::uint64_t turn = 0) {
  const bool legacy = profile == "LEGACY", dual = profile == "RNG19_RFL8_SIG16_NIR16_DUAL";
  Bytes out;
  if (!legacy) out.put<std::uint16_t>(1).text(std::string(30, '\0'));
  for (std::uint16_t c = 0; c < 2; ++c) {
    const auto column = static_cast<std::uint16_t>(first_column + c);
    out.put(std::uint64_t{1'000'000'000} + 12'500'000U * (8 * turn + column)).put(column);
    if (legacy) out.put<std::uint16_t>(5).put<std::uint32_t>(0);
    if (!legacy) out.put<std::uint16_t>(valid ? 1 : 0);
    for (int row = 0; row < 2; ++row) {
      const bool hit = column == 2 && row == 0;
      const std::uint32_t range = hit ? 10240 : 0, second = hit ? 20480 : 0;
      if (dual) {
        out.put(range | 9U << 24U).put(second | 8U << 24U);
        out.put<std::uint16_t>(700).put<std::uint16_t>(600).put<std::uint32_t>(0);
      } else if (profile == "RNG15_RFL8_NIR8") {
        out.put(static_cast<std::uint16_t>(range >> 3U)).put<std::uint8_t>(9).put<std::uint8_t>(0);
      } else {
        out.put(range).put<std::uint16_t>(9).put<std::uint16_t>(700).put<std::uint32_t>(0);
      }
    }
    if (legacy) out.put<std::uint32_t>(valid ? 0xffffffffU : 0U);
  }
  return legacy ? out.str() : out.text(std::string(32, '\0')).str();
}

class OusterProfile : public ::testing::TestWithParam<std::string> {};

// The manual's formula, in the sensor's frame (half a turn about z from the lidar's, 36.18 mm up).
TEST_P(OusterProfile, IsDecodedToTheManualsFormula) {
  const std::string packet = ouster_packet(GetParam());
  const auto decoder =
      recordings::make_ouster_decoder({bytes_of(packet), "", ouster_json(GetParam()), "test"});
  ASSERT_TRUE(decoder);
  const PacketPoints points = decode(*decoder, packet);
  ASSERT_GE(points.points.size(), 1U);
  const double encoder = 2 * std::numbers::pi * (1.0 - 2.0 / 8.0), beam = -3 * kDegree;
  const double along = 10.24 - 0.0158;
  const double x =
      along * std::cos(encoder + beam) * std::cos(10 * kDegree) + 0.0158 * std::cos(encoder);
  const double y =
      along * std::sin(encoder + beam) * std::cos(10 * kDegree) + 0.0158 * std::sin(encoder);
  EXPECT_NEAR(points.points[0].x(), -x, 1e-5);
  EXPECT_NEAR(points.points[0].y(), -y, 1e-5);
  EXPECT_NEAR(points.points[0].z(), along * std::sin(10 * kDegree) + 0.03618, 1e-5);
  EXPECT_EQ(points.attributes.reflectivity.at(0), 9.0F);
  EXPECT_EQ(points.attributes.ring.at(0), 1);
  if (GetParam() != "RNG15_RFL8_NIR8") {
    EXPECT_EQ(points.attributes.intensity.at(0), 700.0F);
  }
  if (GetParam().ends_with("DUAL")) {
    ASSERT_EQ(points.points.size(), 2U);
    EXPECT_THAT(points.attributes.return_number, ::testing::ElementsAre(1, 2));
    EXPECT_EQ(points.attributes.reflectivity[1], 8.0F);
  }
  PacketPoints none;
  decoder->decode(bytes_of(ouster_packet(GetParam(), 2, false)), 0, 2, none);
  EXPECT_TRUE(none.points.empty());  // columns whose status is not good
}

INSTANTIATE_TEST_SUITE_P(Profiles, OusterProfile,
                         ::testing::Values("LEGACY", "RNG19_RFL8_SIG16_NIR16",
                                           "RNG19_RFL8_SIG16_NIR16_DUAL", "RNG15_RFL8_NIR8"));

class Packets : public ::testing::Test {
 protected:
  std::unique_ptr<Recording> open(const std::string& name, const std::string& calibration = "") {
    RecordingOptions options;
    options.calibration = calibration;
    options.attributes = AttributeSet::all();
    return open_recording((folder_ / name).string(), options);
  }
  std::string error_of(const std::string& name) {
    try {
      const auto recording = open(name);
      for (std::size_t i = 0; i < recording->size(); ++i) (void)recording->read(i);
    } catch (const InputError& e) {
      EXPECT_THAT(std::string(e.what()), ::testing::Not(HasSubstr("\n")));
      return e.what();
    }
    return "none";
  }

  // Three turns of a VLP-16 at 10 Hz from azimuth 180 degrees on: 75 packets a turn, each block
  // with one return of laser 1 at 10 m. The sensor's clock passes the full hour; the recorder's
  // shows another time.
  static std::vector<StampedPacket> three_turns() {
    std::vector<StampedPacket> packets;
    for (std::uint32_t i = 0; i < 225; ++i) {
      VelodynePacket packet =
          turning(0x22, static_cast<std::uint16_t>((18000 + 480 * i) % 36000), 40, 1);
      packet.microseconds = (3'599'900'000U + 1'333U * i) % 3'600'000'000U;
      for (int block = 0; block < 12; ++block) packet.echoes[{block, 1}] = {5000, 1};
      packets.push_back({1'600'000'000, 1'333'000 * i + 10'000 * (i % 3), packet.bytes()});
    }
    return packets;
  }
  static std::string bag_of(const std::vector<StampedPacket>& packets) {
    std::vector<testing::BagMessage> messages;
    for (std::size_t i = 0; i < packets.size(); i += 75) {
      const std::vector<StampedPacket> part(
          packets.begin() + static_cast<std::ptrdiff_t>(i),
          packets.begin() + static_cast<std::ptrdiff_t>(std::min(i + 75, packets.size())));
      messages.push_back({static_cast<std::uint32_t>(10 + i), testing::velodyne_scan(part)});
    }
    return testing::make_bag(messages, "none", true, "velodyne_msgs/VelodyneScan");
  }
  testing::TemporaryFolder folder_;
};

TEST_F(Packets, AreCutWhereTheTurnEnds) {
  write_file(folder_ / "a.bag", bag_of(three_turns()));
  const auto recording = open("a.bag");
  EXPECT_EQ(recording->info().format, "rosbag");
  EXPECT_THAT(recording->info().sensor, HasSubstr("VLP-16"));
  // Half a turn at either end is left out: 37.5 packets, then turns from azimuth 0 on.
  ASSERT_EQ(recording->size(), 2U);
  EXPECT_THAT(recording->info().notes, Contains(HasSubstr("not whole")));
  for (std::size_t i = 0; i < 2; ++i) {
    const Scan scan = recording->read(i);
    ASSERT_EQ(scan.points.size(), 900U);
    EXPECT_FLOAT_EQ(scan.times.front(), 2.304e-6F);
    // 899 blocks later: 74 packets of 1 333 us, and 11 blocks of 110.592 us; the scan begins in the
    // middle of a packet.
    EXPECT_NEAR(scan.times.back(), 75 * 1333e-6 - 110.592e-6, 1.2e-4);
    EXPECT_NEAR(std::atan2(-scan.points.front().y(), scan.points.front().x()) / kDegree,
                0.4 * 2.304 / 110.592, 1e-4);
    EXPECT_EQ(scan.attributes.ring.size(), 900U);
  }
  // 37 packets and 6 blocks after the first one, by the clock of the recorder.
  EXPECT_NEAR(1e-9 * static_cast<double>(recording->stamp(0) - 1'600'000'000'000'000'000),
              37 * 1333e-6 + 6 * 110.592e-6, 1e-6);
  EXPECT_EQ(recording->stamp(1) - recording->stamp(0), 75 * 1'333'000);
}

TEST_F(Packets, AreTheSameFromACapture) {
  write_file(folder_ / "a.bag", bag_of(three_turns()));
  std::string capture = testing::pcap_header();
  std::uint16_t id = 0;
  for (const StampedPacket& packet : three_turns()) {
    const std::string datagram = testing::udp(packet.bytes);
    const std::uint32_t us = packet.nanoseconds / 1000;
    // Whole, tagged by a VLAN, or in two parts of which the second comes first.
    if (++id % 3 == 0) {
      capture += testing::pcap_record(
          packet.seconds, us, testing::ethernet_frame(datagram.substr(800), id, 800, false));
      capture += testing::pcap_record(
          packet.seconds, us, testing::ethernet_frame(datagram.substr(0, 800), id, 0, true));
    } else {
      capture += testing::pcap_record(packet.seconds, us,
                                      testing::ethernet_frame(datagram, id, 0, false, id % 2 == 0));
    }
    const std::string position(512, '\1');  // of the GPS receiver
    capture += testing::pcap_record(packet.seconds, us,
                                    testing::ethernet_frame(testing::udp(position), 9, 0, false));
  }
  write_file(folder_ / "a.pcap", capture);
  const auto bag = open("a.bag"), pcap = open("a.pcap");
  EXPECT_EQ(pcap->info().format, "pcap");
  ASSERT_EQ(pcap->size(), bag->size());
  EXPECT_EQ(open(".", "")->size(), bag->size());  // the bag comes first in a folder of both
  for (std::size_t i = 0; i < bag->size(); ++i) {
    EXPECT_EQ(pcap->read(i).points, bag->read(i).points);
    EXPECT_EQ(pcap->read(i).times, bag->read(i).times);
    EXPECT_EQ(pcap->stamp(i), bag->stamp(i));
  }
  EXPECT_THAT(pcap->info().notes, Contains(HasSubstr("225 packets of other kinds")));
}

// Two sensors that were recorded together.
TEST_F(Packets, OneOfSeveralSensorsOfACaptureIsChosen) {
  std::string capture = testing::pcap_header();
  for (const StampedPacket& packet : three_turns()) {
    const std::uint32_t us = packet.nanoseconds / 1000;
    const std::string frame = testing::ethernet_frame(testing::udp(packet.bytes), 1, 0, false);
    std::string other = frame;
    other[29] = '\x07';  // the sender's address: 192.168.1.7
    capture += testing::pcap_record(packet.seconds, us, frame);
    capture += testing::pcap_record(packet.seconds, us, other);
  }
  write_file(folder_ / "two.pcap", capture);
  const auto with_topic = [&](const std::string& topic) {
    RecordingOptions options;
    options.topic = topic;
    return open_recording((folder_ / "two.pcap").string(), options);
  };
  const auto error_of = [&](const std::string& topic) -> std::string {
    try {
      (void)with_topic(topic);
    } catch (const InputError& e) {
      return e.what();
    }
    return "none";
  };
  EXPECT_THAT(error_of(""), HasSubstr("several sensors; choose one with --topic (sender, port or "
                                      "both): 192.168.1.2:2368 (Velodyne VLP-16"));
  EXPECT_THAT(error_of("2368"), HasSubstr("several sensors"));
  EXPECT_THAT(error_of("10.0.0.1"), HasSubstr("has no sensor 10.0.0.1; choose one"));
  for (const char* topic : {"192.168.1.7", "192.168.1.7:2368"}) {
    const auto recording = with_topic(topic);
    ASSERT_EQ(recording->size(), 2U);
    EXPECT_EQ(recording->read(0).points.size(), 900U);
    EXPECT_THAT(recording->info().notes,
                Contains(HasSubstr("Packets are those of 192.168.1.7:2368")));
  }
}

TEST_F(Packets, MissingAndLateOnesAreCountedAndSurvived) {
  std::vector<StampedPacket> packets = three_turns();
  packets.erase(packets.begin() + 60, packets.begin() + 63);
  std::swap(packets[100], packets[101]);
  write_file(folder_ / "a.bag", bag_of(packets));
  const auto recording = open("a.bag");
  ASSERT_EQ(recording->size(), 2U);
  EXPECT_EQ(recording->read(0).points.size(), 900U - 36U);
  EXPECT_EQ(recording->read(1).points.size(), 900U);
  EXPECT_THAT(recording->info().warnings, Contains(HasSubstr("packets are missing")));
}

// A sensor that measures half of its turn, from 270 to 90 degrees: one scan a turn, not two that
// meet at azimuth 0. The packet at the end is filled with the beginning of the next turn, which was
// measured 50 ms after the time that it tells.
TEST_F(Packets, OfAPartOfTheTurnMakeOneScanATurn) {
  std::vector<StampedPacket> packets;
  for (std::uint32_t turn = 0; turn < 4; ++turn) {
    for (std::uint32_t i = 0; i < 38; ++i) {
      VelodynePacket packet =
          turning(0x22, static_cast<std::uint16_t>((27000 + 480 * i) % 36000), 40, 1);
      for (std::size_t block = 6; i == 37 && block < 12; ++block)
        packet.azimuths[block] = static_cast<std::uint16_t>(27000 + 40 * (block - 6));
      for (int block = 0; block < 12; ++block) packet.echoes[{block, 1}] = {5000, 1};
      packet.microseconds = 1'000'000 + 100'000 * turn + 1'327 * i;
      packets.push_back({1'600'000'000, 1000 * (packet.microseconds - 1'000'000), packet.bytes()});
    }
  }
  write_file(folder_ / "a.bag", bag_of(packets));
  const auto recording = open("a.bag");
  ASSERT_EQ(recording->size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(recording->stamp(i) - recording->stamp(0), static_cast<Nanoseconds>(100'000'000 * i));
    const Scan scan = recording->read(i);
    EXPECT_EQ(scan.points.size(), 37U * 12 + 6);
    EXPECT_LT(scan.times.back(), 0.051F);
  }
  EXPECT_THAT(recording->info().warnings, ::testing::Not(Contains(HasSubstr("missing"))));
}

TEST_F(Packets, AClockThatIsSetBackMixesNothing) {
  std::vector<StampedPacket> packets = three_turns();
  for (std::size_t i = 110; i < packets.size(); ++i) {
    const std::uint32_t us = 1'000'000U + 1'333U * static_cast<std::uint32_t>(i);
    packets[i].bytes.replace(1200, 4, Bytes().put(us).str());
  }
  write_file(folder_ / "a.bag", bag_of(packets));
  const auto recording = open("a.bag");
  ASSERT_EQ(recording->size(), 2U);
  EXPECT_NEAR(1e-9 * static_cast<double>(recording->stamp(1) - recording->stamp(0)), 0.1, 1e-3);
  EXPECT_THAT(recording->info().warnings, Contains(HasSubstr("clock was set")));
  const Scan scan = recording->read(0);
  EXPECT_EQ(scan.points.size(), 900U);
  EXPECT_LT(scan.times.back(), 0.101F);
}

TEST_F(Packets, OfHesaiAreReadFromItsMessages) {
  write_file(folder_ / "a.bag",
             testing::make_bag({{10, testing::pandar_scan({{5, 0, xt32_packet(0x37)}})}}, "none",
                               true, "pandar_msgs/PandarScan"));
  const auto recording = open("a.bag");
  ASSERT_EQ(recording->size(), 1U);
  EXPECT_EQ(recording->read(0).points.size(), 1U);
  EXPECT_THAT(recording->info().notes, Contains(HasSubstr("model's manual")));
}

TEST_F(Packets, OfOusterNeedTheirMetadata) {
  const std::string profile = "RNG19_RFL8_SIG16_NIR16_DUAL";
  std::string capture = testing::pcap_header(0xa1b23c4d, 101, true);
  for (std::uint16_t i = 0; i < 12; ++i) {
    const std::string ip = testing::ethernet_frame(
        testing::udp(ouster_packet(profile, static_cast<std::uint16_t>(i % 4 * 2), true, i / 4)), i,
        0, false);
    capture += testing::pcap_record(100 + i, 5, ip.substr(14), true);
  }
  write_file(folder_ / "os1_drive.pcap", capture);
  EXPECT_THAT(error_of("os1_drive.pcap"), HasSubstr("--calibration FILE.json"));
  write_file(folder_ / "os1.json", ouster_json(profile));
  const auto recording = open("os1_drive.pcap");
  EXPECT_EQ(recording->read(0).points.size(), 2U);
  EXPECT_THAT(recording->info().notes, Contains("Metadata are os1.json."));
  EXPECT_THAT(recording->info().sensor, HasSubstr("OS-1-2, 2 beams, 8 columns"));
  write_file(folder_ / "os1.json", ouster_json("RNG99_FUTURE"));
  EXPECT_THAT(error_of("os1_drive.pcap"), HasSubstr("profile RNG99_FUTURE are not decoded"));
  write_file(folder_ / "os1.json", ouster_json("LEGACY"));
  EXPECT_THAT(error_of("os1_drive.pcap"),
              HasSubstr("none is of the form that the Ouster metadata"));
  write_file(folder_ / "os1.json", R"({"beam_altitude_angles": [1, "x"]})");
  EXPECT_THAT(error_of("os1_drive.pcap"),
              HasSubstr("'beam_altitude_angles' holds what is no number"));
}

TEST_F(Packets, ThatAreCutOffOrUnknownAreAnswered) {
  write_file(folder_ / "a.pcap", "no capture at all, but longer than its header");
  EXPECT_THAT(error_of("a.pcap"), HasSubstr("is no pcap capture"));
  write_file(folder_ / "a.pcap", Bytes().put(0x0a0d0d0aU).text(std::string(40, '\0')));
  EXPECT_THAT(error_of("a.pcap"), HasSubstr("editcap -F pcap"));
  write_file(folder_ / "a.pcap", testing::pcap_header());
  EXPECT_THAT(error_of("a.pcap"), HasSubstr("holds no packet"));
  write_file(folder_ / "a.pcap", testing::pcap_header(0xa1b2c3d4, 105));
  EXPECT_THAT(error_of("a.pcap"), HasSubstr("link type 105 is unknown"));
  const std::string robosense = "\x55\xaa\x05\x5a" + std::string(1244, '\0');
  write_file(folder_ / "a.pcap",
             testing::pcap_header() +
                 testing::pcap_record(
                     1, 2, testing::ethernet_frame(testing::udp(robosense), 1, 0, false)));
  EXPECT_THAT(error_of("a.pcap"), HasSubstr("rslidar_sdk"));
  // A message that announces more packets than it has, and a record of four gigabytes.
  std::string scan = testing::velodyne_scan({three_turns().front()});
  scan.replace(24, 4, Bytes().put(0xffffffffU).str());
  write_file(folder_ / "b.bag",
             testing::make_bag({{10, scan}}, "none", true, "velodyne_msgs/VelodyneScan"));
  EXPECT_EQ(open("b.bag")->size(), 1U);
  std::string capture =
      testing::pcap_header() +
      testing::pcap_record(
          1, 2, testing::ethernet_frame(testing::udp(three_turns().front().bytes), 1, 0, false));
  capture += Bytes().put(1U).put(2U).put(0xfffffff0U).put(0xfffffff0U).str();
  write_file(folder_ / "a.pcap", capture);
  const auto recording = open("a.pcap");
  EXPECT_EQ(recording->size(), 1U);
  EXPECT_THAT(recording->info().warnings, Contains(HasSubstr("1 messages or packets are cut off")));
  write_file(folder_ / "scan.osf", "osf");
  EXPECT_THAT(error_of("scan.osf"), HasSubstr("ouster-cli source scan.osf save OUT.pcap"));
}

TEST_F(Packets, OtherTopicsAreAnsweredWithWhatWouldConvertThem) {
  write_file(folder_ / "a.bag",
             testing::make_bag({{10, "x"}}, "none", true, "rslidar_msg/RslidarPacket"));
  EXPECT_THAT(error_of("a.bag"), HasSubstr("convert Robosense packets to PointCloud2"));
}

// livox_ros_driver/CustomMsg, after its published definition; no recorded sample was at hand.
std::string livox_message(bool cdr) {
  Bytes out;
  const auto align = [&](std::size_t size) {
    while (cdr && out.size() % size != 0) out.put<std::uint8_t>(0);
  };
  if (!cdr) out.put<std::uint32_t>(1);
  out.put<std::uint32_t>(9).put<std::uint32_t>(0);
  out.counted<std::uint32_t>(cdr ? std::string("livox_frame\0", 12) : "livox_frame");
  align(8);
  out.put<std::uint64_t>(9'000'000'000).put<std::uint32_t>(2);
  out.put<std::uint8_t>(1).put<std::uint8_t>(0).put<std::uint8_t>(0).put<std::uint8_t>(0);
  out.put<std::uint32_t>(2);
  const auto point = [&](std::uint32_t t, float x, float y, float z, std::uint8_t tag) {
    align(4);
    out.put(t).put(x).put(y).put(z).put<std::uint8_t>(33).put(tag).put<std::uint8_t>(5);
  };
  point(0, 1, 2, 3, 0);
  point(90'000'000, -4.5F, 0.25F, 6, 0x10);
  return cdr ? std::string("\0\1\0\0", 4) + out.str() : out.str();
}

TEST_F(Packets, LivoxMessagesOfBothRosAreRead) {
  for (const bool cdr : {false, true}) {
    const std::string name = cdr ? "l.mcap" : "l.bag";
    if (cdr) {
      const std::string definitions = testing::mcap_schema(1, "livox_ros_driver2/msg/CustomMsg") +
                                      testing::mcap_channel(1, 1, "/livox/lidar");
      write_file(
          folder_ / name,
          testing::kMcapMagic +
              testing::mcap_record(
                  1,
                  Bytes().counted<std::uint32_t>("ros2").counted<std::uint32_t>("by hand").str()) +
              testing::mcap_chunk(definitions + testing::mcap_message(1, 10, livox_message(true)),
                                  "none") +
              testing::mcap_record(15, Bytes().put<std::uint32_t>(0).str()) +
              testing::mcap_record(2, std::string(20, '\0')) + testing::kMcapMagic);
    } else {
      write_file(folder_ / name, testing::make_bag({{10, livox_message(false)}}, "none", true,
                                                   "livox_ros_driver/CustomMsg"));
    }
    const auto recording = open(name);
    ASSERT_EQ(recording->size(), 1U) << name;
    EXPECT_EQ(recording->stamp(0), 9'000'000'000);
    const Scan scan = recording->read(0);
    ASSERT_EQ(scan.points.size(), 2U);
    EXPECT_EQ(scan.points[1], Eigen::Vector3f(-4.5F, 0.25F, 6));
    EXPECT_NEAR(scan.times[1], 0.09, 1e-8);
    EXPECT_THAT(scan.attributes.return_number, ::testing::ElementsAre(1, 2));
    EXPECT_THAT(scan.attributes.ring, ::testing::ElementsAre(5, 5));
    EXPECT_THAT(scan.attributes.reflectivity, ::testing::ElementsAre(33.0F, 33.0F));
  }
}

}  // namespace
}  // namespace groundloop
