// The worlds of the simulation: streets, ways and what two recordings of one world share.
#include <cmath>
#include <limits>
#include <set>

#include <gtest/gtest.h>

#include "frontend/simulation/simulation.hpp"
#include "frontend/simulation/street_network.hpp"
#include "frontend/simulation/street_route.hpp"

namespace groundloop::simulation {
namespace {

using Edge = std::pair<Crossing, Crossing>;

std::vector<Edge> edges(const StreetNetwork& network, const SimulationParameters& parameters) {
  const std::vector<Crossing> crossings = choose_crossings(network, parameters);
  std::vector<Edge> result;
  for (std::size_t i = 1; i < crossings.size(); ++i) {
    result.emplace_back(crossings[i - 1], crossings[i]);
  }
  return result;
}

std::set<Edge> undirected(const std::vector<Edge>& edges) {
  std::set<Edge> result;
  for (const auto& [a, b] : edges) result.insert(std::minmax(a, b));
  return result;
}

TEST(StreetNetwork, EveryCrossingHasAtLeastTwoStreets) {
  const StreetNetwork network(5);
  for (int i = -12; i < 12; ++i) {
    for (int j = -12; j < 12; ++j) {
      int streets = 0;
      for (const Crossing to :
           {Crossing{i + 1, j}, Crossing{i - 1, j}, Crossing{i, j + 1}, Crossing{i, j - 1}}) {
        if (network.between({i, j}, to)) ++streets;
      }
      EXPECT_GE(streets, 2);
    }
  }
}

TEST(StreetRoute, ComesBackInTheSameAndInTheOppositeDirection) {
  const StreetNetwork network(5);
  SimulationParameters parameters;
  parameters.length = 2000;
  std::set<Edge> driven;
  int same = 0, opposite = 0;
  for (const Edge& e : edges(network, parameters)) {
    same += driven.count(e) > 0 ? 1 : 0;
    opposite += driven.count({e.second, e.first}) > 0 ? 1 : 0;
    driven.insert(e);
  }
  EXPECT_GE(same, 2);
  EXPECT_GE(opposite, 2);
}

TEST(StreetRoute, RoutesOfOneWorldDifferAndOverlap) {
  const StreetNetwork network(5);
  SimulationParameters first, second;
  second.route = 2;
  const auto a = edges(network, first), b = edges(network, second);
  EXPECT_NE(a, b);
  int common = 0;
  for (const Edge& e : undirected(a)) common += undirected(b).count(e) > 0 ? 1 : 0;
  EXPECT_GE(common, 3);
}

TEST(StreetRoute, WestAndEastShareOneStreet) {
  for (const std::uint64_t seed : {5U, 6U, 7U}) {
    const StreetNetwork network(seed);
    SimulationParameters west, east;
    west.side = "west";
    east.side = "east";
    east.route = 2;
    int common = 0;
    const auto b = undirected(edges(network, east));
    for (const Edge& e : undirected(edges(network, west))) common += b.count(e) > 0 ? 1 : 0;
    EXPECT_EQ(common, 1) << "seed " << seed;
  }
}

TEST(StreetRoute, BackLeadsAlongTheSameStreetsInTheOtherLane) {
  for (const std::uint64_t seed : {5U, 6U}) {
    const StreetNetwork network(seed);
    SimulationParameters there, back;
    back.way = "back";
    const Way a = plan_street_route(network, there), b = plan_street_route(network, back);
    const Vec2 first = a.points[1] - a.points[0],
               last = b.points[b.points.size() - 1] - b.points[b.points.size() - 2];
    EXPECT_LT(first.normalized().dot(last.normalized()), -0.99) << "seed " << seed;
    // On the left of the way there, no wider than an avenue; streets end 9 m before a crossing.
    const Vec2 offset = b.points.back() - a.points.front();
    const Vec2 left = Vec2(-first.y(), first.x()).normalized();
    EXPECT_GT(offset.dot(left), 1.8) << "seed " << seed;
    EXPECT_LT(offset.norm(), 20.0) << "seed " << seed;
  }
}

class SimulatedWorld : public ::testing::TestWithParam<const char*> {};

TEST_P(SimulatedWorld, HasAWayOfTheAskedLength) {
  const auto recording = open_simulation(std::string("sim:") + GetParam());
  // Gait and springs add to the path of the sensor itself.
  const double wanted = recording->parameters().length;
  EXPECT_GT(path_length(recording->ground_truth()), 0.97 * wanted);
  EXPECT_LT(path_length(recording->ground_truth()), 1.1 * wanted);
}

TEST_P(SimulatedWorld, IsSeen) {
  const auto recording = open_simulation(std::string("sim:") + GetParam());
  const Scan scan = recording->read(recording->size() / 2);
  EXPECT_GT(scan.points.size(), 4000U);
  for (const Eigen::Vector3f& p : scan.points) EXPECT_TRUE(p.allFinite());
}

INSTANTIATE_TEST_SUITE_P(
    All, SimulatedWorld,
    ::testing::Values("town", "town?sensor=spin16&carrier=walker&length=200",
                      "town?sensor=spin64&fov=290", "town?sensor=rosette&length=200",
                      "bridge?sensor=spin32", "park?sensor=raster&carrier=segway&length=200",
                      "park?sensor=spin128&carrier=walker&length=200", "town?side=west",
                      "town?way=back&length=200", "town?length=12000&sensor=spin16"),
    [](const auto& instance) {
      std::string name = instance.param;
      std::erase_if(name, [](char c) { return std::isalnum(static_cast<unsigned char>(c)) == 0; });
      return name;
    });

/// The fewest points of every `step`-th scan; a sensor within a solid sees none.
std::size_t fewest_points(const std::string& specification, std::size_t step) {
  const auto recording = open_simulation(specification);
  std::size_t fewest = std::numeric_limits<std::size_t>::max();
  for (std::size_t i = 0; i < recording->size(); i += step) {
    fewest = std::min(fewest, recording->read(i).points.size());
  }
  return fewest;
}

// All worlds, carriers and several seeds are in slow/simulation_ways_test.cpp.
TEST(SimulatedWay, LeadsThroughNoSolid) {
  EXPECT_GT(fewest_points("sim:town?sensor=spin16&carrier=walker&length=160&seed=5", 12), 5000U);
  EXPECT_GT(fewest_points("sim:bridge?sensor=spin16&carrier=segway&length=160&seed=2", 12), 5000U);
}

TEST(Simulation, ABlindSectorLiesBehind) {
  const Scan scan = open_simulation("sim:town?sensor=spin16&length=100&fov=290")->read(3);
  ASSERT_GT(scan.points.size(), 1000U);
  for (const Eigen::Vector3f& p : scan.points) {
    EXPECT_LE(std::abs(std::atan2(p.y(), p.x())), 145.0F * 3.14159265F / 180.0F + 1e-5F);
  }
}

TEST(Simulation, AWalkerSwingsUpToThirtyDegrees) {
  const auto recording = open_simulation("sim:park?sensor=spin16&carrier=walker&length=200");
  double most = 0.0;
  for (const StampedPose& p : recording->ground_truth()) {
    most = std::max(most, std::acos((p.pose.rotation * Eigen::Vector3d::UnitZ()).z()));
  }
  EXPECT_GT(most, 25.0 * M_PI / 180.0);
  EXPECT_LT(most, 42.0 * M_PI / 180.0);  // both angles at once
}

TEST(Simulation, AnotherDayIsTheSamePlace) {
  // The way and the ground stay; some of what stands about does not.
  const auto today = open_simulation("sim:town?length=200"),
             later = open_simulation("sim:town?length=200&change=1");
  const Pose a = today->ground_truth().front().pose, b = later->ground_truth().front().pose;
  EXPECT_LT((a.translation - b.translation).norm(), 0.2);
  EXPECT_NE(today->read(0).points.size(), later->read(0).points.size());
}

}  // namespace
}  // namespace groundloop::simulation
