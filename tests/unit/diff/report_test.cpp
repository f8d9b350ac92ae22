// What pages and terminals get: text that cannot do harm, Base64, pictures that fit.

#include "random_images.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <puppetwarp/base/output_file.h>
#include <puppetwarp/diff/display.h>
#include <puppetwarp/diff/html_report.h>
#include <puppetwarp/diff/page_text.h>
#include <puppetwarp/diff/printable.h>
#include <puppetwarp/diff/side_by_side.h>

#include "support/run_command.h"

#include <algorithm>
#include <string>

namespace puppetwarp::testing {
namespace {

using ::testing::HasSubstr;

TEST(Printable, KeepsLettersOfAllKindsAndSpellsOutTheRest) {
    EXPECT_EQ(printable("plain name.png"), "plain name.png");
    EXPECT_EQ(printable("gr\xc3\xbc\xc3\x9f \xe2\x82\xac \xf0\x9f\x98\x80"),
              "gr\xc3\xbc\xc3\x9f \xe2\x82\xac \xf0\x9f\x98\x80");
    EXPECT_EQ(printable("a\nb\x1b[31m\x7f"), "a\\x0ab\\x1b[31m\\x7f");
    EXPECT_EQ(printable("\xff\xc3"), "\\xff\\xc3");
    EXPECT_EQ(printable("\xc0\x80"), "\\xc0\\x80");                    // too long a form of 0
    EXPECT_EQ(printable("\xed\xa0\x80"), "\\xed\\xa0\\x80");           // a surrogate
    EXPECT_EQ(printable("\xf5\x80\x80\x80"), "\\xf5\\x80\\x80\\x80");  // beyond Unicode
    EXPECT_EQ(printable("\xe2\x80\xaegnp"), "\\xe2\\x80\\xaegnp");     // turns the direction of writing
    EXPECT_EQ(printable("\xe2\x80"), "\\xe2\\x80");                    // cut short
}

TEST(PageText, NothingEndsATagOrAQuote) {
    EXPECT_EQ(html_text("<a b='c'>\"&</a>"), "&lt;a b=&#39;c&#39;&gt;&quot;&amp;&lt;/a&gt;");
}

TEST(PageText, Base64IsThatOfTheStandard) {
    // RFC 4648, section 10.
    EXPECT_EQ(base64(""), "");
    EXPECT_EQ(base64("f"), "Zg==");
    EXPECT_EQ(base64("fo"), "Zm8=");
    EXPECT_EQ(base64("foo"), "Zm9v");
    EXPECT_EQ(base64("foob"), "Zm9vYg==");
    EXPECT_EQ(base64("fooba"), "Zm9vYmE=");
    EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
    EXPECT_EQ(base64("\xff\xfe\xfb"), "//77");
}

TEST(PagePicture, IsEightBitsAndFits) {
    std::mt19937 random(1);
    const Image deep = random_image(450, 20, CV_16U, 4, random);
    const PagePicture whole = page_picture(deep, 450);
    EXPECT_EQ(whole.shrunk, 1);
    EXPECT_EQ(whole.pixels.type(), CV_8UC4);
    EXPECT_EQ(whole.pixels.cols, 450);
    const PagePicture part = page_picture(deep, 200);
    EXPECT_EQ(part.shrunk, 3);
    EXPECT_EQ(part.pixels.cols, 150);
    EXPECT_EQ(part.pixels.rows, 7);
    EXPECT_EQ(page_picture(random_image(3, 1000, CV_8U, 1, random), 100).pixels.cols, 1);
}

TEST(Display, ShowsChequersWhereTransparent) {
    Image image = blank_image(20, 20, CV_32F, 2);
    image.pixels.at<cv::Vec2f>(0, 0) = {0.5F, 1};
    const cv::Mat shown = display_rgb(image);
    EXPECT_EQ(shown.at<cv::Vec3b>(0, 0), cv::Vec3b::all(128));
    EXPECT_NE(shown.at<cv::Vec3b>(3, 3), shown.at<cv::Vec3b>(3, 11));
}

ComparedFiles compared(const Image& expected, const Image& actual) {
    ShownComparison shown = compare_and_show(expected, actual);
    return {shown.comparison, expected, actual, shown.heat_map};
}

TEST(SideBySide, HoldsThePicturesPixelByPixel) {
    std::mt19937 random(2);
    const Image expected = random_image(300, 100, CV_8U, 3, random), actual = changed_image(expected, CV_8U, 9, random);
    const ComparedFiles files = compared(expected, actual);
    const Image sheet = side_by_side(files);
    int found = 0;
    for (const Image* image : {&files.expected, &files.actual, &files.heat_map}) {
        for (int y = 0; y + 100 <= sheet.height(); ++y) {
            for (int x = 0; x + 300 <= sheet.width(); ++x) {
                const cv::Mat part = sheet.pixels(cv::Rect(x, y, 300, 100));
                bool same = part.at<cv::Vec3b>(0, 0) == image->pixels.at<cv::Vec3b>(0, 0);
                for (int row = 0; same && row < 100; ++row) {
                    same = std::equal(part.ptr(row), part.ptr(row) + 900, image->pixels.ptr(row));
                }
                found += same ? 1 : 0;
            }
        }
    }
    EXPECT_EQ(found, 3);
}

TEST(SideBySide, PicturesOfOtherSizesAndOfOnePixelAreShownToo) {
    std::mt19937 random(3);
    const Image small = random_image(1, 1, CV_8U, 1, random), large = random_image(220, 3, CV_16U, 4, random);
    EXPECT_GT(side_by_side(compared(small, large)).width(), 221);
    EXPECT_GT(side_by_side(compared(small, small)).width(), 600);
}

TEST(HtmlReport, KeepsTheRowsAndLeavesOutPicturesThatHaveNoRoom) {
    const tests::TemporaryFolder folder;
    HtmlReport report("exp", "act", 1000);
    PairResult pair{"a.png", PairState::different, {}, {}};
    pair.comparison.comparable = true;
    const std::string large(501, 'x');
    for (int i = 0; i < 3; ++i) report.add(pair, HtmlReport::Pictures{large, "y", "", 1});
    OutputFile file(folder / "page.html");
    report.write(file);
    file.commit();
    const std::string page = tests::bytes_of(folder / "page.html");
    EXPECT_THAT(page, HasSubstr("1 pairs are in the table only"));
    EXPECT_THAT(page, HasSubstr("data-pictures=\"1\""));
    EXPECT_EQ(page.find("data-pictures=\"2\""), std::string::npos);
}

TEST(HtmlReport, TheReasonStandsBesideThePictureAndItsHeading) {
    const tests::TemporaryFolder folder;
    HtmlReport report("exp", "act");
    PairResult pair{"a.png", PairState::different, {}, {}};
    pair.comparison.reason = "3 pixels differ";
    report.add(pair, std::nullopt);
    OutputFile file(folder / "page.html");
    report.write(file);
    file.commit();
    const std::string page = tests::bytes_of(folder / "page.html");
    EXPECT_THAT(page, HasSubstr(">Picture</th><th tabindex=\"0\">Reason</th>"));
    EXPECT_THAT(page, HasSubstr("<td class=\"path\">a.png</td><td class=\"reason\">3 pixels differ</td>"));
    // Each row has as many cells as there are headings.
    const auto count = [&](const std::string& what) {
        std::size_t found = 0;
        for (std::size_t at = page.find(what); at != std::string::npos; at = page.find(what, at + 1)) ++found;
        return found;
    };
    EXPECT_EQ(count("<td"), count("<th "));
}

}  // namespace
}  // namespace puppetwarp::testing
