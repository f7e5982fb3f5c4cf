#include "apps/report/blobs.hpp"

#include <cstring>
#include <string>

#include <gtest/gtest.h>
#include <zlib.h>

namespace groundloop::apps {
namespace {

std::vector<std::byte> bytes_of(const std::string& text) {
  std::vector<std::byte> bytes(text.size());
  std::memcpy(bytes.data(), text.data(), text.size());
  return bytes;
}

// RFC 4648, section 10.
TEST(Blobs, Base64IsThatOfTheStandard) {
  const std::pair<const char*, const char*> vectors[] = {{"", ""},
                                                         {"f", "Zg=="},
                                                         {"fo", "Zm8="},
                                                         {"foo", "Zm9v"},
                                                         {"foob", "Zm9vYg=="},
                                                         {"fooba", "Zm9vYmE="},
                                                         {"foobar", "Zm9vYmFy"}};
  for (const auto& [plain, coded] : vectors) EXPECT_EQ(base64(bytes_of(plain)), coded);
}

TEST(Blobs, DeflatedBytesComeBackByZlib) {
  const std::vector<std::byte> plain = bytes_of(std::string(5000, 'a') + "an end");
  const std::vector<std::byte> packed = deflate_bytes(plain);
  EXPECT_LT(packed.size(), 100U);
  std::vector<std::byte> back(plain.size());
  uLongf size = back.size();
  ASSERT_EQ(uncompress(reinterpret_cast<Bytef*>(back.data()), &size,
                       reinterpret_cast<const Bytef*>(packed.data()), packed.size()),
            Z_OK);
  EXPECT_EQ(back, plain);
}

TEST(Blobs, BytesOfEqualWeightStandTogether) {
  EXPECT_EQ(shuffle_bytes(bytes_of("aAbBcC"), 2), bytes_of("abcABC"));
}

TEST(Blobs, AnArrayIsNamedByItsPlaceTypeAndLength) {
  Blobs blobs;
  const std::vector<float> floats{1.0F, 2.0F, 3.0F};
  const std::vector<std::uint16_t> words{7};
  EXPECT_EQ(blobs.add(std::span<const float>(floats)).dump(),
            R"({"blob":0,"type":"f32","length":3})");
  EXPECT_EQ(blobs.add(std::span<const std::uint16_t>(words)).dump(),
            R"({"blob":1,"type":"u16","length":1})");
  const std::string html = blobs.html();
  EXPECT_NE(html.find("id=\"blob-0\""), std::string::npos);
  EXPECT_NE(html.find("id=\"blob-1\""), std::string::npos);
  EXPECT_EQ(blobs.html(), "");  // given out once
}

}  // namespace
}  // namespace groundloop::apps
