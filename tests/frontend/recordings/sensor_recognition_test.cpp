// Sensors told by their points: scans made after the data sheets.
#include "frontend/recordings/sensor_recognition.hpp"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace groundloop::recordings {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

Eigen::Vector3f point(double azimuth_deg, double elevation_deg, double range) {
  const double a = azimuth_deg * M_PI / 180.0, e = elevation_deg * M_PI / 180.0;
  return {static_cast<float>(range * std::cos(e) * std::cos(a)),
          static_cast<float>(range * std::cos(e) * std::sin(a)),
          static_cast<float>(range * std::sin(e))};
}

TEST(SensorRecognition, Vlp16IsToldByTheBeamsThatAreSeen) {
  Scan scan;  // the manual: 16 beams two degrees apart; the lowest two see nothing
  for (int beam = 2; beam < 16; ++beam) {
    for (int i = 0; i < 360; ++i) {
      scan.points.push_back(point(i + 0.5, -15 + 2 * beam, 10));
      scan.attributes.ring.push_back(static_cast<std::uint16_t>(beam));
    }
  }
  const SensorEvidence found = recognise_sensor({scan});
  EXPECT_EQ(found.rings, 14U);
  EXPECT_THAT(found.models, ElementsAre("Velodyne VLP-16"));
  EXPECT_THAT(found.described(), HasSubstr("14 of its 16 beams are seen"));
}

TEST(SensorRecognition, AviaIsToldByItsFieldOfView) {
  Scan scan;  // 70.4 by 77.2 degrees
  for (int i = 0; i < 70; ++i)
    for (int k = 0; k < 77; ++k) scan.points.push_back(point(i - 34.8, k - 38.2, 10));
  EXPECT_THAT(recognise_sensor({scan}).models, ElementsAre("Livox Avia"));
}

TEST(SensorRecognition, BeamsOfNoKnownSensorAreNamedNothing) {
  Scan scan;
  for (int beam = 0; beam < 20; ++beam) {
    for (int i = 0; i < 360; ++i) {
      scan.points.push_back(point(i + 0.5, -40 + 3 * beam, 10));
      scan.attributes.ring.push_back(static_cast<std::uint16_t>(beam));
    }
  }
  const SensorEvidence found = recognise_sensor({scan});
  EXPECT_TRUE(found.models.empty());
  EXPECT_EQ(found.described(), "20 rings from -40.0 to +17.0 degrees, the whole turn");
  EXPECT_EQ(recognise_sensor({Scan()}).described(), "");
}

}  // namespace
}  // namespace groundloop::recordings
