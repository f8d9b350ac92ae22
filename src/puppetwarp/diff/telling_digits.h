#pragma once

namespace puppetwarp {

//! How many significant digits tell two numbers apart when they are written: 6, more where those are the same for
//! both, at most 17. Of equal numbers 6.
int telling_digits(double a, double b);

}  // namespace puppetwarp
