// draw LEVEL OUT [WORDS]   Writes a grey square; WORDS, when given, have arrived whole.
#include <puppetwarp/image/write.h>

#include <cstdlib>
#include <cstring>

int main(int argc, char** argv) {
    if (argc < 3 || (argc > 3 && std::strcmp(argv[3], "two words; a semicolon") != 0)) return 3;
    puppetwarp::Image image;
    image.pixels = cv::Mat(16, 16, CV_8UC1, cv::Scalar(std::atoi(argv[1])));
    puppetwarp::write_image(image, argv[2]);
    return 0;
}
