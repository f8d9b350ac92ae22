#include <puppetwarp/image/tone_curves.h>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <random>
#include <string>
#include <vector>

namespace puppetwarp {
namespace {

// A profile of a header and tags, big-endian, as ICC.1:2022 lays them out.
class Profile {
public:
    static void put(std::vector<std::uint8_t>& bytes, std::uint32_t value, int size) {
        for (int k = size - 1; k >= 0; --k) bytes.push_back(static_cast<std::uint8_t>(value >> (8 * k)));
    }

    static std::vector<std::uint8_t> curve(const std::vector<std::uint16_t>& values) {
        std::vector<std::uint8_t> data{'c', 'u', 'r', 'v', 0, 0, 0, 0};
        put(data, static_cast<std::uint32_t>(values.size()), 4);
        for (const std::uint16_t value : values) put(data, value, 2);
        return data;
    }

    static std::vector<std::uint8_t> parametric(int type, const std::vector<double>& parameters) {
        std::vector<std::uint8_t> data{'p', 'a', 'r', 'a', 0, 0, 0, 0};
        put(data, static_cast<std::uint32_t>(type), 2);
        put(data, 0, 2);
        for (const double p : parameters) put(data, static_cast<std::uint32_t>(std::lround(p * 65536)), 4);
        return data;
    }

    void add(const std::string& signature, std::vector<std::uint8_t> data) {
        signatures_.push_back(signature);
        data_.push_back(std::move(data));
    }

    std::vector<std::uint8_t> bytes() const {
        std::vector<std::uint8_t> bytes(128);
        put(bytes, static_cast<std::uint32_t>(signatures_.size()), 4);
        std::size_t at = 132 + 12 * signatures_.size();
        for (std::size_t i = 0; i < signatures_.size(); ++i) {
            bytes.insert(bytes.end(), signatures_[i].begin(), signatures_[i].end());
            put(bytes, static_cast<std::uint32_t>(at), 4);
            put(bytes, static_cast<std::uint32_t>(data_[i].size()), 4);
            at += data_[i].size();
        }
        for (const auto& data : data_) bytes.insert(bytes.end(), data.begin(), data.end());
        return bytes;
    }

private:
    std::vector<std::string> signatures_;
    std::vector<std::vector<std::uint8_t>> data_;
};

Image picture(int type, std::vector<std::uint8_t> icc = {}) {
    Image image{cv::Mat(2, 2, type, cv::Scalar::all(0)), {}};
    image.metadata.icc = std::move(icc);
    return image;
}

Image grey_with(std::vector<std::uint8_t> curve) {
    Profile profile;
    profile.add("kTRC", std::move(curve));
    return picture(CV_8UC1, profile.bytes());
}

TEST(ToneCurves, AreThoseOfSrgbWithoutAProfile) {
    for (const int type : {CV_8UC1, CV_8UC2, CV_16UC3, CV_8UC4}) {
        const std::vector<ToneCurve> curves = tone_curves(picture(type));
        ASSERT_EQ(curves.size(), 1U);
        // Of the standard's own examples and ends.
        EXPECT_NEAR(curves[0](0), 0, 1e-12);
        EXPECT_NEAR(curves[0](1), 1, 1e-12);
        EXPECT_NEAR(curves[0](0.04045), 0.0031308, 1e-7);
        EXPECT_NEAR(curves[0](188 / 255.0), 0.5029, 1e-4);
        EXPECT_NEAR(curves[0](0.5), 0.21404, 1e-5);
    }
}

TEST(ToneCurves, OfAllKindsAreRead) {
    const auto at = [](const Image& image, double x) { return tone_curves(image)[0](x); };
    EXPECT_NEAR(at(grey_with(Profile::curve({})), 0.3), 0.3, 1e-12);
    EXPECT_NEAR(at(grey_with(Profile::curve({563})), 0.3), std::pow(0.3, 563 / 256.0), 1e-12);  // 2.2 in 8.8 bits
    EXPECT_NEAR(at(grey_with(Profile::curve({0, 6553, 65535})), 0.25), 6553 / 65535.0 / 2, 1e-9);
    EXPECT_NEAR(at(grey_with(Profile::curve({0, 6553, 65535})), 1), 1, 1e-12);
    EXPECT_NEAR(at(grey_with(Profile::parametric(0, {1.8})), 0.3), std::pow(0.3, 1.8), 1e-5);
    EXPECT_NEAR(at(grey_with(Profile::parametric(1, {2, 0.5, 0.25})), 0.5), 0.25, 1e-5);
    EXPECT_NEAR(at(grey_with(Profile::parametric(2, {2, 0.5, 0.25, 0.1})), 0.5), 0.35, 1e-5);
    const std::vector<double> srgb{2.4, 1 / 1.055, 0.055 / 1.055, 1 / 12.92, 0.04045};
    for (const double x : {0.01, 0.04, 0.05, 0.5, 0.99}) {
        EXPECT_NEAR(at(grey_with(Profile::parametric(3, srgb)), x), srgb_light(x), 2e-5) << x;
    }
    EXPECT_NEAR(at(grey_with(Profile::parametric(4, {2, 1, 0, 0.5, 0.2, 0.05, 0.01})), 0.1), 0.06, 1e-4);
    EXPECT_NEAR(at(grey_with(Profile::parametric(4, {2, 1, 0, 0.5, 0.2, 0.05, 0.01})), 0.5), 0.3, 1e-4);
}

TEST(ToneCurves, OfColourChannelsMayDiffer) {
    Profile profile;
    profile.add("rTRC", Profile::curve({256}));
    profile.add("gTRC", Profile::curve({512}));
    profile.add("bTRC", Profile::curve({768}));
    const std::vector<ToneCurve> curves = tone_curves(picture(CV_16UC4, profile.bytes()));
    ASSERT_EQ(curves.size(), 3U);
    for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(curves[c](0.5), std::pow(0.5, 1.0 + static_cast<double>(c)), 1e-12);
    // Grey pictures look for their own curve, and find none.
    EXPECT_NEAR(tone_curves(picture(CV_8UC1, profile.bytes()))[0](0.5), srgb_light(0.5), 1e-12);
}

// Cut short, or with bytes that say something else: sRGB or some curve, never a crash.
TEST(ToneCurves, OfBrokenProfilesDoNoHarm) {
    std::mt19937 random(5);
    Profile profile;
    for (const char* signature : {"rTRC", "gTRC", "bTRC"}) profile.add(signature, Profile::curve({0, 99, 65535}));
    const std::vector<std::uint8_t> whole = profile.bytes();
    for (std::size_t size = 0; size < whole.size(); ++size) {
        std::vector<std::uint8_t> broken(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
        EXPECT_NEAR(tone_curves(picture(CV_8UC3, broken))[0](0), 0, 1e-9);
    }
    for (int round = 0; round < 2000; ++round) {
        std::vector<std::uint8_t> broken = whole;
        for (int k = 0; k < 3; ++k)
            broken[128 + random() % (broken.size() - 128)] = static_cast<std::uint8_t>(random());
        for (const ToneCurve& curve : tone_curves(picture(CV_8UC3, broken))) {
            EXPECT_FALSE(std::isnan(curve(0.5)));
        }
    }
}

}  // namespace
}  // namespace puppetwarp
