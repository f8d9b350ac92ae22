#pragma once

#include "pictures.h"
#include "support/run_command.h"

#include <puppetwarp/image/write.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

namespace puppetwarp::tests {

using Json = nlohmann::json;

//! Two pictures that differ in six pixels by 8 levels, and `puppetwarp diff` between them.
class Diff : public testing::Test {
protected:
    Diff() {
        Image picture = noise_picture(60, 40, CV_8UC3);
        write_image(picture, a);
        for (int i = 0; i < 6; ++i) picture.pixels.at<cv::Vec3b>(5 * i, 10 * i)[1] ^= 8;  // 6 pixels, 8 levels
        write_image(picture, b);
    }

    CommandResult diff(std::vector<std::string> more, const std::string& first, const std::string& second) const {
        std::vector<std::string> arguments{"diff", first, second};
        arguments.insert(arguments.end(), more.begin(), more.end());
        const CommandResult result = puppetwarp_command(std::move(arguments));
        EXPECT_EQ(result.signal, 0);
        return result;
    }
    int exit_code(std::vector<std::string> more) const { return diff(std::move(more), a, b).exit_code; }
    Json report(std::vector<std::string> more, const std::string& first, const std::string& second) const {
        more.emplace_back("--json");
        return Json::parse(diff(std::move(more), first, second).output);
    }

    // One line on standard error, nothing on standard output.
    void expect_refused(const CommandResult& result, const std::string& mentions, int exit_code = 2) const {
        EXPECT_EQ(result.exit_code, exit_code) << result.errors << result.output;
        EXPECT_THAT(result.errors, testing::StartsWith("puppetwarp: "));
        EXPECT_EQ(std::count(result.errors.begin(), result.errors.end(), '\n'), 1) << result.errors;
        EXPECT_THAT(result.errors, testing::HasSubstr(mentions));
        EXPECT_EQ(result.output, "");
    }

    TemporaryFolder folder;
    std::string a = folder / "a.png";
    std::string b = folder / "b.png";
};

}  // namespace puppetwarp::tests
