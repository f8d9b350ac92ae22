#include <puppetwarp/testing/image_test.h>

puppetwarp::Image grey(int level) {
    puppetwarp::Image image;
    image.pixels = cv::Mat(16, 16, CV_8UC1, cv::Scalar(level));
    return image;
}

TEST(Grey, Passes) {
    EXPECT_IMAGE_NEAR(grey(100), "grey.png");
}

TEST(Grey, Fails) {
    EXPECT_IMAGE_NEAR(grey(140), "grey.png");
}
