#include "tests/fuzz/seeds.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <functional>
#include <map>

#include "apps/commands/commands.hpp"
#include "apps/config/config.hpp"
#include "backend/merging/session_matching.hpp"
#include "frontend/core/error.hpp"
#include "frontend/core/files.hpp"
#include "frontend/core/pcd.hpp"
#include "frontend/recordings/point_layout.hpp"
#include "frontend/simulation/layouts/layout_writer.hpp"
#include "tests/fuzz/scratch_folder.hpp"
#include "tests/fuzz/targets/run_states.hpp"
#include "tests/support/bag_bytes.hpp"
#include "tests/support/packet_bytes.hpp"

namespace groundloop::fuzz {
namespace fs = std::filesystem;
using testing::Bytes;

namespace {

using Seeds = std::vector<std::string>;

// Scans of small_scan() as a recording.
class SmallRecording final : public Recording {
 public:
  explicit SmallRecording(std::size_t scans) : scans_(scans) {}
  const RecordingInfo& info() const override { return info_; }
  std::size_t size() const override { return scans_; }
  Nanoseconds stamp(std::size_t index) const override { return small_scan(index).stamp; }
  Scan read(std::size_t index) override { return small_scan(index); }
  Trajectory ground_truth() const override {
    Trajectory truth;
    for (std::size_t i = 0; i < scans_; ++i)
      truth.push_back({stamp(i), Pose(Eigen::Quaterniond::Identity(),
                                      {0.5 * static_cast<double>(i), 0.0, 0.0})});
    return truth;
  }

 private:
  std::size_t scans_;
  RecordingInfo info_;
};

// The files of a folder as one input; `leave_out` by their names.
std::string bundle_of(const fs::path& folder, const std::vector<std::string>& leave_out = {}) {
  std::vector<std::pair<std::string, std::string>> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    const std::string name = fs::relative(entry.path(), folder).string();
    if (std::find(leave_out.begin(), leave_out.end(), name) != leave_out.end()) continue;
    files.emplace_back(name, read_text(entry.path()));
  }
  std::sort(files.begin(), files.end());
  return join_bundle(files);
}

std::string in_layout(const std::string& layout, const std::string& sensor = "Ouster") {
  const fs::path folder = scratch_folder() / "layout";
  fs::remove_all(folder);
  SmallRecording recording(2);
  write_layout(recording, layout, folder, sensor);
  return bundle_of(folder);
}

void run_groundloop(std::vector<std::string> words) {
  words.insert(words.begin(), {"groundloop", "--quiet", "--threads", "1"});
  std::vector<const char*> argv;
  for (const std::string& word : words) argv.push_back(word.c_str());
  check(apps::run_command_line(static_cast<int>(argv.size()), argv.data()) == 0, "a seed is made");
}

// A finished session of three local maps, as it lies on the disk.
const fs::path& small_session() {
  static const fs::path session = [] {
    const fs::path input = scratch_folder() / "input";
    SmallRecording recording(6);
    write_layout(recording, "folder", input);
    fs::path out = scratch_folder() / "small";
    run_groundloop({"run", input.string(), "--out", out.string(), "--set", "local_maps.max_scans=2",
                    "--set", "map.write=false"});
    return out;
  }();
  return session;
}

const fs::path& merged_session() {
  static const fs::path session = [] {
    const fs::path other = scratch_folder() / "second";
    fs::copy(small_session(), other, fs::copy_options::recursive);
    fs::path out = scratch_folder() / "both";
    run_groundloop({"merge", small_session().string(), other.string(), "--out", out.string(),
                    "--set", "map.write=false"});
    return out;
  }();
  return session;
}

// What no reader asks for, which is most of a session's length.
const std::vector<std::string> kUnread{"report.html", "run.log", "metrics.json", "config.yaml",
                                       "trajectory.kitti"};

Seeds session_seeds() {
  return {bundle_of(small_session(), kUnread), bundle_of(merged_session(), kUnread)};
}

Seeds session_command_seeds() {
  Seeds seeds;
  for (const std::string& session : session_seeds()) {
    for (const char command : std::string("elmjcpt")) seeds.push_back(command + session);
  }
  return seeds;
}

Seeds with_session_files(const std::vector<std::string>& names) {
  Seeds seeds;
  for (const fs::path& session : {small_session(), merged_session()}) {
    for (const std::string& name : names) {
      if (fs::exists(session / name)) seeds.push_back(read_text(session / name));
    }
  }
  return seeds;
}

LoopDatabase small_database() {
  LoopDatabase database{LoopClosureOptions{}};
  for (int map = 0; map < 6; ++map) {
    MapDescription d;
    d.key = {map / 5, map % 5};
    d.T_ground_map.translation.z() = 1.5;
    for (int i = 0; i < 8; ++i) {
      d.keypoints.emplace_back(static_cast<float>(7 * i), static_cast<float>(i * i));
      d.orientations.push_back(0.1F * static_cast<float>(i));
      Descriptor descriptor{};
      for (std::size_t k = 0; k < descriptor.size(); ++k)
        descriptor[k] = 0x9e3779b97f4a7c15ULL * (static_cast<std::uint64_t>(i) + k + 1);
      d.descriptors.push_back(descriptor);
    }
    database.insert(std::move(d));
  }
  return database;
}

Seeds loop_database_seeds() {
  const std::vector<std::byte> bytes = small_database().bytes();
  // The target adds the checksum.
  return {std::string(reinterpret_cast<const char*>(bytes.data()),
                      bytes.size() - sizeof(std::uint64_t))};
}

Seeds matches_seeds() {
  PairMatches pair{"a", "b", 1, 2, {}};
  for (int i = 0; i < 3; ++i) {
    ClosureRecord c;
    c.reference_session = "a";
    c.query_session = "b";
    c.reference_map = i;
    c.query_map = 2 - i;
    c.overlap = 0.5;
    c.status = i == 0 ? ClosureStatus::accepted : ClosureStatus::low_overlap;
    c.information = Matrix6d::Identity();
    pair.closures.push_back(c);
  }
  const fs::path file = scratch_folder() / "matches.csv";
  write_matches(file, {pair});
  const std::string text = read_text(file);
  return {text.substr(0, text.rfind("# end"))};
}

Seeds checkpoint_seeds() {
  const SessionFolder folder(scratch_folder() / "begun");
  RunState state = small_run_state(folder);
  go_on(state);
  go_on(state);
  Checkpoint(folder, run_identity()).save(state);
  return {read_text(folder.file("checkpoint.bin")).substr(2 * sizeof(std::uint64_t))};
}

Seeds configuration_seeds() {
  Seeds seeds{apps::to_yaml(apps::Config{}),
              "odometry:\n  voxel_size: 0.5\nlocal_maps: {length: 50}\n"};
  for (const std::string& name : apps::preset_names())
    seeds.push_back(apps::to_yaml(apps::effective_config(name, {})));
  return seeds;
}

Seeds point_cloud2_seeds() {
  testing::CloudSpec spec = testing::cloud_at(9, 5);
  Seeds seeds{"1" + testing::ros1_cloud(spec), "2" + testing::cdr_cloud(spec),
              "2" + testing::cdr_cloud(spec, true)};
  spec.big_endian_points = true;
  seeds.push_back("1" + testing::ros1_cloud(spec));
  spec = testing::cloud_at(9, 0);
  spec.height = 2;
  spec.width = 1;
  spec.row_step = 20;
  spec.data = testing::points_of({}).insert(16, "padd");
  seeds.push_back("1" + testing::ros1_cloud(spec));
  return seeds;
}

std::string file_bundle(const std::string& name, const std::string& content) {
  return join_bundle({{name, content}});
}

Seeds rosbag_seeds() {
  Seeds seeds{in_layout("rosbag")};
  const std::vector<testing::BagMessage> messages{
      {10, testing::ros1_cloud(testing::cloud_at(9, 0))},
      {11, testing::ros1_cloud(testing::cloud_at(9, 100'000'000))}};
  for (const char* compression : {"none", "lz4", "bz2"}) {
    for (const bool indexed : {true, false})
      seeds.push_back(file_bundle("a.bag", testing::make_bag(messages, compression, indexed)));
  }
  return seeds;
}

std::string velodyne_packet(std::uint16_t azimuth) {
  testing::VelodynePacket packet;
  for (std::size_t block = 0; block < 12; ++block) {
    packet.azimuths[block] = static_cast<std::uint16_t>((azimuth + 40 * block) % 36000);
    packet.echoes[{static_cast<int>(block), 3}] = {5000, 9};
  }
  packet.microseconds = 1333U * (azimuth / 480U);
  return packet.bytes();
}

Seeds packet_seeds() {
  std::string xt32("\xee\xff\6\1\0\0\x20\x8\1\4\1\1", 12);
  xt32.resize(1080, '\1');
  return {'\0' + velodyne_packet(0), '\1' + xt32,
          '\2' + Bytes()
                     .put<std::uint32_t>(1)
                     .put<std::uint64_t>(9)
                     .counted<std::uint32_t>("livox")
                     .put<std::uint64_t>(9)
                     .put<std::uint32_t>(1)
                     .put<std::uint32_t>(0)
                     .put<std::uint32_t>(1)
                     .put<std::uint32_t>(0)
                     .floats(1, 2, 3)
                     .put<std::uint32_t>(7)
                     .str()};
}

Seeds pcap_seeds() {
  std::string capture = testing::pcap_header();
  for (std::uint16_t i = 0; i < 100; ++i) {
    const std::string datagram =
        testing::udp(velodyne_packet(static_cast<std::uint16_t>(480U * i % 36000U)));
    capture += testing::pcap_record(9, 1333U * i,
                                    testing::ethernet_frame(datagram.substr(0, 800), i, 0, true));
    capture += testing::pcap_record(9, 1333U * i,
                                    testing::ethernet_frame(datagram.substr(800), i, 800, false));
  }
  return {join_bundle({{"a.pcap", capture},
                       {"a.json", R"({"beam_altitude_angles": [10], "beam_azimuth_angles": [0],)"
                                  R"("lidar_mode": "512x10"})"}})};
}

Seeds mcap_seeds() {
  Seeds seeds{in_layout("mcap")};
  for (const char* compression : {"none", "lz4", "zstd"}) {
    for (const bool summary : {true, false}) {
      testing::McapSpec spec;
      spec.compression = compression;
      spec.summary = summary;
      seeds.push_back(file_bundle("a.mcap", testing::make_mcap(spec)));
    }
  }
  return seeds;
}

Seeds rosbag2_seeds() {
  Seeds seeds{in_layout("rosbag2")};
  const std::string cloud = testing::cdr_cloud(testing::cloud_at(9, 0));
  const fs::path file = scratch_folder() / "seed.db3";
  const auto database = [&](const std::string& message) {
    fs::remove(file);
    testing::make_db3(file, {message}, 512);
    return read_text(file);
  };
  seeds.push_back(join_bundle(
      {{"metadata.yaml", testing::metadata("b.db3", "", "sqlite3")}, {"b.db3", database(cloud)}}));
  seeds.push_back(join_bundle({{"metadata.yaml", testing::metadata("m.db3", "MESSAGE", "sqlite3")},
                               {"m.db3", database(testing::compress(cloud, "zstd"))}}));
  seeds.push_back(
      join_bundle({{"metadata.yaml", testing::metadata("f.db3.zstd", "FILE", "sqlite3")},
                   {"f.db3.zstd", testing::compress(database(cloud), "zstd")}}));
  seeds.push_back(file_bundle("c.mcap.zstd", testing::compress(testing::make_mcap({}), "zstd")));
  seeds.push_back(file_bundle("d.db3", database(cloud)));
  return seeds;
}

Seeds helipr_seeds() {
  Seeds seeds;
  for (const char* sensor : {"Ouster", "Velodyne", "Avia", "Aeva"})
    seeds.push_back(in_layout("helipr", sensor));
  return seeds;
}

std::string float_points(std::size_t scan, bool with_intensity = true) {
  Bytes bytes;
  for (const Eigen::Vector3f& p : small_scan(scan).points) {
    bytes.floats(p.x(), p.y(), p.z());
    if (with_intensity) bytes.floats(0.5F);
  }
  return bytes.str();
}

Seeds kitti_raw_seeds() {
  const std::string calibration =
      "calib_time: 09-Jan-2012 13:57:47\nR: 1 0 0 0 1 0 0 0 1\n"
      "T: -0.8 0.3 -0.7\n";
  std::vector<std::pair<std::string, std::string>> files{
      {"velodyne_points/data/0000000000.bin", float_points(0)},
      {"velodyne_points/data/0000000001.bin", float_points(1)},
      {"velodyne_points/timestamps.txt",
       "2011-09-26 13:02:25.050000000\n2011-09-26 13:02:25.150000000\n"},
      {"velodyne_points/timestamps_start.txt",
       "2011-09-26 13:02:25.000000001\n2011-09-26 13:02:25.100000001\n"},
      {"velodyne_points/timestamps_end.txt",
       "2011-09-26 13:02:25.100000000\n2011-09-26 13:02:25.200000000\n"},
      {"oxts/timestamps.txt", "2011-09-26 13:02:25.0\n2011-09-26 13:02:26.0\n"},
      {"oxts/data/0000000000.txt", "49 8 100 0.01 0 0 1 2 3\n"},
      {"oxts/data/0000000001.txt", "49 8.0001 100 0 0 1.5 1 2 3\n"}};
  return {join_bundle(files), join_bundle({files[0], files[1], files[2]})};
}

std::string pcd_header(const std::string& data) {
  return "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z t\nSIZE 4 4 4 4\nTYPE F F F U\nCOUNT 1 1 1 1\n"
         "WIDTH 2\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 2\nDATA " +
         data + "\n";
}

Seeds pcd_seeds() {
  Bytes compressed, binary;
  compressed.text(pcd_header("binary_compressed"));
  compressed.put(std::uint32_t{33}).put(std::uint32_t{32}).put(std::uint8_t{31});
  compressed.floats(1, -4.5, 2, 0.25, 3, 6).put(std::uint32_t{0}).put(std::uint32_t{90'000'000});
  binary.text(pcd_header("binary")).floats(1, 2, 3).put(std::uint32_t{0});
  binary.floats(-4.5, 0.25, 6).put(std::uint32_t{90'000'000});
  return {pcd_header("ascii") + "1 2 3 0\nnan nan nan 5\n", compressed.str(), binary.str()};
}

Seeds ply_seeds() {
  const std::string vertices =
      "property float x\nproperty float y\nproperty float z\nproperty double t\nend_header\n";
  Bytes little, big;
  little.text(
      "ply\nformat binary_little_endian 1.0\nelement camera 1\nproperty int id\n"
      "element vertex 2\n" +
      vertices);
  little.put(std::int32_t{7}).floats(1, 2, 3).put(0.0).floats(4, 5, 6).put(0.1);
  big.text("ply\nformat binary_big_endian 1.0\ncomment of a sensor\nelement vertex 2\n" + vertices);
  for (const float v : {1.0F, 2.0F, 3.0F}) big.put_big(v);
  big.put_big(0.0);
  for (const float v : {4.0F, 5.0F, 6.0F}) big.put_big(v);
  big.put_big(0.1);
  return {
      little.str(), big.str(),
      "ply\nformat ascii 1.0\nelement camera 1\nproperty int id\nelement vertex 2\nproperty "
      "double x\nproperty double y\nproperty double z\nproperty uint t\nend_header\n7\n1 2 3 0\n"
      "-4.5 0.25 6 50000000\n"};
}

Seeds folder_seeds() {
  return {
      in_layout("folder"),
      join_bundle({{"1700000000000000000.pcd", pcd_seeds()[1]},
                   {"1700000000100000000.pcd", pcd_seeds()[2]}}),
      join_bundle({{"a_1583840211_83000000.ply", ply_seeds()[0]},
                   {"a_1583840211_183000000.ply", ply_seeds()[0]},
                   {"gt.txt", "1583840211.083 0 0 0 0 0 0 1\n1583840211.183 1 0 0 0 0 0 1\n"}}),
      join_bundle(
          {{"times.txt", "0.0\n0.1\n"}, {"0.bin", float_points(0)}, {"1.bin", float_points(1)}})};
}

Seeds nclt_seeds() {
  Seeds seeds{in_layout("nclt")};
  Bytes hits;
  for (const Eigen::Vector3f& p : small_scan(0).points) {
    for (int k = 0; k < 3; ++k) hits.put(static_cast<std::uint16_t>((p[k] + 100.0F) / 0.005F));
    hits.put(std::uint8_t{9}).put(std::uint8_t{3});
  }
  seeds.push_back(join_bundle({{"velodyne_sync/1326030975726043.bin", hits.str()},
                               {"velodyne_sync/1326030975826043.bin", hits.str()},
                               {"groundtruth_2012-01-08.csv",
                                "1326030975726043,0,0,0,0,0,0\n1326030975826043,1,0,0,0,0,0.1\n"
                                "1326030975926043,nan,nan,nan,nan,nan,nan\n"}}));
  return seeds;
}

Seeds compression_seeds() {
  const std::string text = "the same words, the same words, the same words again";
  Seeds seeds;
  const auto with_head = [&](std::uint8_t kind, const std::string& packed) {
    return Bytes().put(kind).put(static_cast<std::uint32_t>(text.size())).text(packed).str();
  };
  for (const auto& [kind, name] : std::map<std::uint8_t, std::string>{
           {0, "none"}, {1, "lz4"}, {2, "bz2"}, {3, "zstd"}, {4, "zstd"}, {5, "zstd"}})
    seeds.push_back(with_head(kind, testing::compress(text, name)));
  return seeds;
}

Seeds front_end_seeds() {
  Seeds seeds;
  for (const std::uint8_t timed : {std::uint8_t{0}, std::uint8_t{1}}) {
    Bytes bytes;
    for (std::size_t i = 0; i < 4; ++i) {
      const Scan scan = small_scan(i);
      bytes.put(static_cast<std::uint16_t>(scan.points.size())).put(timed).put(scan.stamp);
      for (std::size_t k = 0; k < scan.points.size(); ++k) {
        const Eigen::Vector3f& p = scan.points[k];
        bytes.floats(p.x(), p.y(), p.z());
        if (timed != 0) bytes.floats(0.001F * static_cast<float>(k));
      }
    }
    seeds.push_back(bytes.str());
  }
  return seeds;
}

Seeds trajectory_seeds() {
  std::string tum, kitti, apart;
  for (int i = 0; i < 30; ++i) {
    const std::string x = std::to_string(3 * i), y = std::to_string(i * i % 7);
    tum += std::to_string(i) + ".5 " + x + " " + y +
           " 0 0 0 0.7071067811865476 "
           "0.7071067811865476\n";
    kitti += "0 -1 0 " + x + " 1 0 0 " + y + " 0 0 1 0\n";
    apart += std::to_string(i) + " 500000000 " + x + " " + y + " 0 0 0 0 1\n";
  }
  return {tum + "\n" + tum, kitti + "\n" + kitti, tum + "\n" + apart, apart + "\n" + tum};
}

// Two points of x, y, z and a time each, as point_layout's head describes them.
Seeds point_layout_seeds() {
  Bytes bytes;
  bytes.put(std::uint8_t{4});
  const std::array<std::uint8_t, 4> names{0, 1, 2, 3};  // x, y, z, t
  for (const std::uint8_t name : names) {
    const bool time = name == 3;
    bytes.put(name).put(static_cast<std::uint8_t>(time ? recordings::FieldType::uint32
                                                       : recordings::FieldType::float32));
    bytes.put(static_cast<std::uint16_t>(4 * name)).put(std::uint16_t{16});
  }
  bytes.put(Nanoseconds{1'000'000'000}).put(std::uint16_t{2});
  for (const std::uint32_t time : {0U, 50'000'000U}) bytes.floats(1, 2, 3).put(time);
  return {bytes.str()};
}

Seeds nuscenes_seeds() {
  const std::string scan = Bytes().floats(1, 2, 3, 40, 7, -1, 0, 5, 20, 31).str();
  return {join_bundle(
      {{"v1.0-mini/scene.json", R"([{"token": "s", "name": "scene-0061"}])"},
       {"v1.0-mini/sample.json", R"([{"token": "a", "scene_token": "s"}])"},
       {"v1.0-mini/sample_data.json",
        R"([{"sample_token": "a", "ego_pose_token": "e", "calibrated_sensor_token": "c",
             "timestamp": 1532402927647951, "filename": "samples/LIDAR_TOP/1.pcd.bin"}])"},
       {"v1.0-mini/ego_pose.json",
        R"([{"token": "e", "rotation": [1, 0, 0, 0], "translation": [400.0, 1000.0, 0]}])"},
       {"v1.0-mini/calibrated_sensor.json",
        R"([{"token": "c", "rotation": [1, 0, 0, 0], "translation": [0.9, 0, 1.8]}])"},
       {"samples/LIDAR_TOP/1.pcd.bin", scan}})};
}

Seeds truth_convention_seeds() {
  const std::string scan = Bytes().floats(1, 2, 3, 4, 5, 6, 7, 8).str();
  return {join_bundle({{"lidar/1605635976234567.bin", scan},
                       {"applanix/lidar_poses.csv",
                        "GPSTime,easting,northing,altitude,vel_east,vel_north,vel_up,roll,pitch,"
                        "heading,angvel_z,angvel_y,angvel_x\n"
                        "1605635976234567,100.5,200.25,3,0,0,0,0.1,0.2,0.5,0,0,0\n"}}),
          join_bundle({{"raw_format/ouster_scan/1583836591.182590976.bin", scan},
                       {"ground_truth/registered_poses.csv",
                        "#sec,nsec,x,y,z,qx,qy,qz,qw\n1583836591,182590976,0,0,0,0,0,0,1\n"}}),
          join_bundle({{"lidar-clouds/1710338123.5.bin", scan},
                       {"gt-tum.txt", "1710338123.5 0 0 0 0 0 0 1\n"}})};
}

const std::map<std::string, std::function<Seeds()>>& makers() {
  static const std::map<std::string, std::function<Seeds()>> all{
      {"checkpoint", checkpoint_seeds},
      {"closure_list", [] { return with_session_files({"closures.csv"}); }},
      {"compression", compression_seeds},
      {"configuration", configuration_seeds},
      {"folder", folder_seeds},
      {"front_end", front_end_seeds},
      {"g2o", [] { return with_session_files({"pose_graph.g2o"}); }},
      {"helipr", helipr_seeds},
      {"kitti", [] { return Seeds{in_layout("kitti")}; }},
      {"kitti_raw", kitti_raw_seeds},
      {"local_map", [] { return with_session_files({"local_maps/000000.pcd"}); }},
      {"loop_database", loop_database_seeds},
      {"lzf", [] { return Seeds{std::string("\0\1", 2) + std::string(300, 'a') + "bcd"}; }},
      {"manifest", [] { return with_session_files({"manifest.json"}); }},
      {"matches", matches_seeds},
      {"mcap", mcap_seeds},
      {"mulran", [] { return Seeds{in_layout("mulran")}; }},
      {"nclt", nclt_seeds},
      {"nuscenes", nuscenes_seeds},
      {"optimize", [] { return with_session_files({"pose_graph.g2o"}); }},
      {"packets", packet_seeds},
      {"pcap", pcap_seeds},
      {"pcd", pcd_seeds},
      {"ply", ply_seeds},
      {"point_layout", point_layout_seeds},
      {"point_cloud2", point_cloud2_seeds},
      {"rosbag", rosbag_seeds},
      {"rosbag2", rosbag2_seeds},
      {"scan_file", [] { return with_session_files({"scans/000000.bin"}); }},
      {"session", session_seeds},
      {"session_commands", session_command_seeds},
      {"settings",
       [] { return Seeds{"odometry.voxel_size=0.5\nlocal_maps.length=50\nmap.write=false\n"}; }},
      {"simulation",
       [] {
         return Seeds{"town?sensor=spin16&length=450&seed=401&route=2&change=1",
                      "bridge?length=300&noise=0.02"};
       }},
      {"stamps",
       [] {
         return Seeds{
             "1700000000000000000.bin\n1700000000100000000.bin\n\n"
             "1700000000.0\n1700000000.1\n",
             "a_1583840211_83000000.pcd\na_1583840211_183000000.pcd\n\n0\n1e-1\n"};
       }},
      {"suite",
       [] {
         return Seeds{
             "title: Two towns\nrecordings:\n  - name: town_{seed}\n    group: town\n"
             "    path: sim:town?length=450&seed={seed}\n    for: {seed: [401, 402]}\n"
             "pairs:\n  - reference: town_401\n    query: town_402\n    group: apart\n"
             "    overlap: false\nconfigurations:\n  - name: default\n"};
       }},
      {"tables",
       [] {
         return with_session_files({"closures.csv", "local_maps.csv"});
       }},
      {"trajectory", trajectory_seeds},
      {"truth_conventions", truth_convention_seeds}};
  return all;
}

}  // namespace

std::vector<std::string> made_seeds(const std::string& target) {
  const auto maker = makers().find(target);
  return maker == makers().end() ? Seeds{} : maker->second();
}

}  // namespace groundloop::fuzz
