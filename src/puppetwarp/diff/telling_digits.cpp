#include <puppetwarp/diff/telling_digits.h>

#include <limits>
#include <sstream>
#include <string>

namespace puppetwarp {

namespace {

constexpr int kUsual = 6;

std::string written(double value, int digits) {
    std::ostringstream text;
    text.precision(digits);
    text << value;
    return text.str();
}

}  // namespace

int telling_digits(double a, double b) {
    for (int digits = kUsual; digits <= std::numeric_limits<double>::max_digits10; ++digits) {
        if (written(a, digits) != written(b, digits)) return digits;
    }
    return kUsual;
}

}  // namespace puppetwarp
