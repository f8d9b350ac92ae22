// `puppetwarp diff` from outside: every option, exit codes, bad input.

#include "diff_pictures.h"

#include <puppetwarp/image/read.h>

#include <limits>

#include <sys/stat.h>
#include <unistd.h>

namespace puppetwarp::tests {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

TEST_F(Diff, EachRuleIsReachedByItsOption) {
    EXPECT_EQ(exit_code({}), 1);
    EXPECT_EQ(exit_code({"--threshold", "8/255"}), 0);
    EXPECT_EQ(exit_code({"--threshold", "0.0313"}), 1);
    EXPECT_EQ(exit_code({"--fail-pixels", "6"}), 0);
    EXPECT_EQ(exit_code({"--fail-pixels", "5"}), 1);
    EXPECT_EQ(exit_code({"--fail-percent", "0.25"}), 0);
    EXPECT_EQ(exit_code({"--fail-percent", "0.24"}), 1);
    EXPECT_EQ(exit_code({"--fail-pixels", "6", "--hard-fail", "8/255"}), 0);
    EXPECT_EQ(exit_code({"--fail-pixels", "6", "--hard-fail", "7/255"}), 1);
    EXPECT_EQ(exit_code({"--metric", "max", "--threshold", "8/255"}), 0);
    EXPECT_EQ(exit_code({"--metric", "rmse", "--threshold", "0.001"}), 0);
    EXPECT_EQ(exit_code({"--metric", "rmse", "--threshold", "0.0005"}), 1);
    EXPECT_EQ(exit_code({"--metric", "psnr", "--threshold", "60"}), 0);
    EXPECT_EQ(exit_code({"--metric", "psnr", "--threshold", "61"}), 1);
    EXPECT_EQ(exit_code({"--metric", "ssim", "--threshold", "0.999"}), 0);
    EXPECT_EQ(exit_code({"--metric", "ssim"}), 1);
    EXPECT_EQ(exit_code({"--min-ssim", "0.999"}), 0);
    EXPECT_EQ(exit_code({"--min-ssim", "1"}), 1);
    EXPECT_EQ(exit_code({"--metric", "flip", "--threshold", "0.5"}), 0);
    EXPECT_EQ(exit_code({"--metric", "flip", "--threshold", "0"}), 1);
    EXPECT_EQ(exit_code({"--threshold", "8/255", "--window", "40"}), 0);
    EXPECT_EQ(exit_code({"--threshold", "8/255", "--window", "1"}), 1);
    EXPECT_EQ(exit_code({"--threshold", "8/255", "--window", "1", "--window-threshold", "8/255"}), 0);
}

TEST_F(Diff, ThePersonsEyeIsNearOrFar) {
    Image grey = disc_picture(80, 60), dotted = grey;
    dotted.pixels = grey.pixels.clone();
    for (int y = 20; y < 40; ++y) {
        for (int x = 30; x < 50; ++x) dotted.pixels.at<cv::Vec4b>(y, x)[0] += (x + y) % 2 == 0 ? 40 : -40;
    }
    write_image(grey, folder / "grey.png");
    write_image(dotted, folder / "dotted.png");
    const auto seen = [&](const char* ppd) {
        return report({"--metric", "flip", "--ppd", ppd}, folder / "grey.png", folder / "dotted.png")["flip"]
            .get<double>();
    };
    EXPECT_GT(seen("20"), 1.5 * seen("200"));
}

TEST_F(Diff, MaskAndIgnore) {
    EXPECT_EQ(exit_code({"--ignore", "0,0,1,1", "--ignore", "10,5,50,35"}), 0);
    EXPECT_EQ(exit_code({"--ignore", "10,5,50,35"}), 1);
    Image mask;
    mask.pixels = cv::Mat(40, 60, CV_8UC1, cv::Scalar(255));
    for (int i = 0; i < 6; ++i) mask.pixels.at<std::uint8_t>(5 * i, 10 * i) = 0;
    write_image(mask, folder / "mask.png");
    EXPECT_EQ(exit_code({"--mask", folder / "mask.png"}), 0);
    mask.pixels.at<std::uint8_t>(0, 0) = 255;
    write_image(mask, folder / "mask.png");
    const Json json = report({"--mask", folder / "mask.png"}, a, b);
    EXPECT_EQ(json["differing_pixels"], 1);
    EXPECT_EQ(json["compared_pixels"], 60 * 40 - 5);
}

TEST_F(Diff, AntialiasingShiftAndAlpha) {
    // A black triangle, its slanted edge soft or hard.
    Image soft, hard;
    soft.pixels = cv::Mat(50, 50, CV_8UC3, cv::Scalar::all(255));
    hard.pixels = soft.pixels.clone();
    for (int y = 0; y < 50; ++y) {
        for (int x = 0; x < 50; ++x) {
            const double cover = std::clamp(y - 10 - 0.3 * x, 0.0, 1.0);
            soft.pixels.at<cv::Vec3b>(y, x) = cv::Vec3b::all(static_cast<std::uint8_t>(255 - 255 * cover));
            hard.pixels.at<cv::Vec3b>(y, x) = cv::Vec3b::all(cover < 0.5 ? 255 : 0);
        }
    }
    write_image(soft, folder / "soft.png");
    write_image(hard, folder / "hard.png");
    EXPECT_EQ(diff({}, folder / "soft.png", folder / "hard.png").exit_code, 1);
    const Json aa = report({"--aa"}, folder / "soft.png", folder / "hard.png");
    EXPECT_EQ(aa["same"], true);
    EXPECT_GT(aa["antialiased_pixels"], 10);

    const Image noise = noise_picture(80, 70, CV_8UC3);
    write_image({noise.pixels(cv::Rect(5, 5, 60, 50)), {}}, folder / "here.png");
    write_image({noise.pixels(cv::Rect(2, 6, 60, 50)), {}}, folder / "there.png");
    EXPECT_EQ(diff({}, folder / "here.png", folder / "there.png").exit_code, 1);
    EXPECT_EQ(diff({"--shift", "2"}, folder / "here.png", folder / "there.png").exit_code, 1);
    const Json moved = report({"--shift", "3"}, folder / "here.png", folder / "there.png");
    EXPECT_EQ(moved["same"], true);
    EXPECT_EQ(moved["shift"], Json({3, -1}));

    Image disc = disc_picture(40, 30);
    write_image(disc, folder / "disc.png");
    disc.pixels.at<cv::Vec4b>(0, 0) = {1, 2, 3, 0};
    write_image(disc, folder / "hidden.png");
    EXPECT_EQ(diff({"--alpha", "straight"}, folder / "disc.png", folder / "hidden.png").exit_code, 1);
    EXPECT_EQ(diff({"--alpha", "premultiplied"}, folder / "disc.png", folder / "hidden.png").exit_code, 0);
    Image opaque;
    cv::Mat flat(30, 40, CV_8UC3, cv::Scalar(120, 130, 140));
    opaque.pixels = flat;
    write_image(opaque, folder / "opaque.png");
    EXPECT_EQ(diff({}, folder / "disc.png", folder / "opaque.png").exit_code, 1);
    EXPECT_EQ(diff({"--alpha", "ignore"}, folder / "disc.png", folder / "opaque.png").exit_code, 0);
}

TEST_F(Diff, MetadataOnDemand) {
    Image plain;
    plain.pixels = cv::Mat(8, 8, CV_8UC3, cv::Scalar(10, 20, 30));
    write_image(plain, folder / "plain.png");
    Image described = plain;
    described.metadata.x_pixels_per_mm = described.metadata.y_pixels_per_mm = 11.811;
    write_image(described, folder / "described.png");
    EXPECT_EQ(diff({}, folder / "plain.png", folder / "described.png").exit_code, 0);
    const CommandResult told = diff({"--metadata"}, folder / "plain.png", folder / "described.png");
    EXPECT_EQ(told.exit_code, 1);
    EXPECT_THAT(told.output, HasSubstr("resolution differs: expected none"));

    // The same square upright and upside down in the file: one tag, orientation, of a TIFF block.
    for (const unsigned char orientation : {1, 3}) {
        Image turned = plain;
        turned.metadata.exif = {'I', 'I', 42, 0, 8, 0,           0, 0, 1, 0, 0x12, 1, 3,
                                0,   1,   0,  0, 0, orientation, 0, 0, 0, 0, 0,    0, 0};
        write_image(turned, folder / ("turned" + std::to_string(orientation) + ".png"));
    }
    EXPECT_EQ(diff({}, folder / "turned1.png", folder / "turned3.png").exit_code, 0);
    const Json json = report({"--metadata"}, folder / "turned1.png", folder / "turned3.png");
    EXPECT_EQ(json["same"], false);
    EXPECT_THAT(json["metadata"], ElementsAre("the orientation in the file differs: expected 1, actual 3"));
    EXPECT_THAT(json["failed"], ElementsAre("metadata"));
}

TEST_F(Diff, SpeaksToPeopleToScriptsAndNotAtAll) {
    const CommandResult people = diff({}, a, b);
    EXPECT_THAT(people.output, StartsWith("different: 6 pixels differ (0.25 %)"));
    EXPECT_THAT(people.output, HasSubstr("Max error  = 0.0313725 @ (0, 0) in G"));
    EXPECT_EQ(diff({}, a, a).output, "same\n");
    EXPECT_EQ(diff({"-q"}, a, b).output, "");
    const Json json = report({"--report", folder / "report.json"}, a, b);
    EXPECT_EQ(json, Json::parse(bytes_of(folder / "report.json")));
    for (const char* key : {"same",
                            "reason",
                            "width",
                            "height",
                            "max",
                            "max_at",
                            "mean",
                            "rmse",
                            "psnr",
                            "ssim",
                            "differing_pixels",
                            "differing_percent",
                            "bounding_box",
                            "failed",
                            "metric",
                            "threshold",
                            "metadata",
                            "compared_pixels",
                            "max_channel",
                            "max_values",
                            "flip",
                            "flip_max",
                            "flip_max_at",
                            "antialiased_pixels",
                            "densest_window",
                            "shift"}) {
        EXPECT_TRUE(json.contains(key)) << key;
    }
    EXPECT_EQ(json["bounding_box"], Json({{"x", 0}, {"y", 0}, {"width", 51}, {"height", 26}}));
    EXPECT_EQ(json["ssim"], nullptr);
    EXPECT_GT(report({"--min-ssim", "0.5"}, a, b)["ssim"], 0.9);
    // Null where there is nothing to tell.
    const Json sizes = report({}, a, [&] {
        write_image(noise_picture(61, 40, CV_8UC3), folder / "wide.png");
        return folder / "wide.png";
    }());
    EXPECT_EQ(sizes["max"], nullptr);
    EXPECT_THAT(sizes["failed"], ElementsAre("size"));
}

TEST_F(Diff, VerboseTellsWhatEachStageTook) {
    const testing::Matcher<std::string> stage_lines =
        testing::MatchesRegex("(read|compare|write) +[0-9.]+ ms\n(.|\n)*write +[0-9.]+ ms\n");
    const CommandResult pair = diff({"-v", "--heatmap", folder / "map.png"}, a, b);
    EXPECT_EQ(pair.exit_code, 1);
    EXPECT_THAT(pair.errors, stage_lines);
    EXPECT_THAT(pair.errors, HasSubstr("\ncompare "));
    EXPECT_EQ(pair.output, diff({}, a, b).output);
    for (const char* side : {"exp", "act"}) {
        fs::create_directory(folder / side);
        fs::copy_file(a, folder / side + "/a.png");
    }
    EXPECT_THAT(diff({"-v"}, folder / "exp", folder / "act").errors, stage_lines);
    EXPECT_EQ(diff({}, a, b).errors, "");
}

TEST_F(Diff, EightSixteenBitsAndFloatsCompare) {
    const Image picture = noise_picture(30, 20, CV_8UC3);
    Image deep, real;
    picture.pixels.convertTo(deep.pixels, CV_16U, 257);
    cv::divide(picture.pixels, cv::Scalar::all(255), real.pixels, 1, CV_32F);
    write_image(picture, folder / "8.png");
    write_image(deep, folder / "16.tif");
    write_image(real, folder / "float.pfm");
    EXPECT_EQ(diff({}, folder / "8.png", folder / "16.tif").exit_code, 0);
    EXPECT_EQ(diff({}, folder / "8.png", folder / "float.pfm").exit_code, 0);
    real.pixels.at<cv::Vec3f>(3, 4)[2] = std::numeric_limits<float>::quiet_NaN();
    write_image(real, folder / "nan.pfm");
    EXPECT_EQ(diff({"--threshold", "1"}, folder / "float.pfm", folder / "nan.pfm").exit_code, 1);
    EXPECT_EQ(diff({}, folder / "nan.pfm", folder / "nan.pfm").exit_code, 0);
    const Json json = report({}, folder / "float.pfm", folder / "nan.pfm");
    EXPECT_EQ(json["max"], nullptr);
    EXPECT_EQ(json["max_at"], Json({4, 3}));
}

TEST_F(Diff, PicturesOfTheDifference) {
    ASSERT_EQ(diff({"--heatmap", folder / "heat.png", "--side-by-side", folder / "side.png"}, a, b).exit_code, 1);
    EXPECT_EQ(read_image(folder / "heat.png").width(), 60);
    const Image side = read_image(folder / "side.png");
    EXPECT_GT(side.width(), 3 * 4 * 60);  // enlarged four times: small pixels are to be seen
    EXPECT_GT(side.height(), 4 * 40);
    // Of another size there is no heat map, but both can be seen.
    write_image(noise_picture(61, 40, CV_8UC3), folder / "wide.png");
    const CommandResult wide =
        diff({"--heatmap", folder / "none.png", "--side-by-side", folder / "both.png"}, a, folder / "wide.png");
    EXPECT_EQ(wide.exit_code, 1);
    EXPECT_THAT(wide.errors, HasSubstr("none.png: is not written: the sizes differ"));
    EXPECT_FALSE(fs::exists(folder / "none.png"));
    EXPECT_TRUE(fs::exists(folder / "both.png"));
}

TEST_F(Diff, APictureGoesToStandardOutputAlone) {
    const CommandResult result = diff({"--heatmap", "-"}, a, b);
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_THAT(result.output, StartsWith("\x89PNG"));
    expect_refused(diff({"--heatmap", "-", "--html", "-"}, a, b), "standard output");
    expect_refused(diff({"--side-by-side", "-", "--json"}, a, b), "standard output");
}

TEST_F(Diff, BadInputOnEitherSide) {
    put_bytes(folder / "empty.png", "");
    put_bytes(folder / "text.png", "no picture");
    const std::string whole = bytes_of(a);
    put_bytes(folder / "cut.png", whole.substr(0, whole.size() / 2));
    fs::create_directory(folder / "dir");
    fs::create_symlink("loop.png", folder / "loop.png");
    ASSERT_EQ(::mkfifo((folder / "pipe.png").c_str(), 0600), 0);
    for (const std::string bad : {"missing.png", "empty.png", "text.png", "cut.png", "dir", "loop.png", "pipe.png"}) {
        SCOPED_TRACE(bad);
        const std::string mentions = bad == "dir" ? "folder" : bad;
        expect_refused(diff({}, folder / bad, b), mentions);
        expect_refused(diff({}, a, folder / bad), mentions);
    }
    // Of two bad ones the expected picture is complained of, however often one tries.
    for (int i = 0; i < 10; ++i) {
        expect_refused(diff({}, folder / "cut.png", folder / "text.png"), "cut.png: the file is truncated or damaged");
        expect_refused(diff({}, folder / "text.png", folder / "cut.png"), "text.png: is not a picture");
    }
}

TEST_F(Diff, OptionsOutsideTheirRange) {
    for (const std::vector<std::string>& bad :
         std::vector<std::vector<std::string>>{{"--threshold", "2"},
                                               {"--threshold", "-1"},
                                               {"--threshold", "nan"},
                                               {"--threshold", "1/0"},
                                               {"--threshold", "300/255"},
                                               {"--threshold", ""},
                                               {"--threshold", "4/255x"},
                                               {"--metric", "mse"},
                                               {"--metric", "psnr", "--threshold", "-3"},
                                               {"--metric", "rmse", "--threshold", "1.5"},
                                               {"--metric", "ssim", "--threshold", "7"},
                                               {"--metric", "rmse", "--aa"},
                                               {"--metric", "ssim", "--fail-pixels", "3"},
                                               {"--metric", "psnr", "--fail-percent", "3"},
                                               {"--fail-pixels", "-1"},
                                               {"--fail-pixels", "many"},
                                               {"--fail-percent", "101"},
                                               {"--fail-percent", "nan"},
                                               {"--hard-fail", "1.1"},
                                               {"--min-ssim", "1.5"},
                                               {"--min-ssim", "-0.5"},
                                               {"--window", "-2"},
                                               {"--window-threshold", "0.1"},
                                               {"--window", "3", "--window-threshold", "2"},
                                               {"--shift", "-1"},
                                               {"--shift", "100000"},
                                               {"--alpha", "none"},
                                               {"--metric", "flip", "--ppd", "0"},
                                               {"--metric", "flip", "--ppd", "inf"},
                                               {"--ppd", "40"},
                                               {"--ignore", "1,2,3"},
                                               {"--ignore", "1,2,3,4,5"},
                                               {"--ignore", "1,2,0,4"},
                                               {"--ignore", "a,b,c,d"},
                                               {"--ignore", "100,2,3,4"},
                                               {"--ignore", "0,0,60,40"}}) {
        const std::string option = bad[bad.size() - 2].substr(0, 2) == "--" ? bad[bad.size() - 2] : bad.back();
        SCOPED_TRACE(option + " " + bad.back());
        const CommandResult result = diff(bad, a, b);
        EXPECT_EQ(result.exit_code, 2) << result.output;
        EXPECT_EQ(std::count(result.errors.begin(), result.errors.end(), '\n'), 1) << result.errors;
        EXPECT_THAT(result.errors, HasSubstr(option.substr(2))) << result.errors;
    }
    expect_refused(diff({"--mask", folder / "missing.png"}, a, b), "missing.png");
    write_image(noise_picture(61, 40, CV_8UC1), folder / "mask.png");
    expect_refused(diff({"--mask", folder / "mask.png"}, a, b), "mask: it has 61 x 40 pixels, the picture 60 x 40");
}

TEST_F(Diff, OutputsThatCannotBeWritten) {
    fs::create_directory(folder / "folder.png");
    for (const char* option : {"--heatmap", "--side-by-side", "--html", "--report"}) {
        expect_refused(diff({option, folder / "nowhere/out.png"}, a, b), "nowhere");
        expect_refused(diff({option, a}, a, b), "is the input itself (choose another name)\n");
        expect_refused(diff({option, folder / "folder.png"}, a, b), "is a folder");
    }
    expect_refused(diff({"--heatmap", folder / "map.bmp"}, a, b), "map.bmp");
    // As from a script's variable that is not set: nothing would be written, and nobody would know.
    for (const char* option : {"--heatmap", "--side-by-side", "--html", "--report", "--mask"}) {
        expect_refused(diff({option, ""}, a, b), std::string(option) + ": it must not be empty");
    }
    expect_refused(diff({"--heatmap", folder / "x.png", "--side-by-side", folder / "x.png"}, a, b), "two results");
}

}  // namespace
}  // namespace puppetwarp::tests
