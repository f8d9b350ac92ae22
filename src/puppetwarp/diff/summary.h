#pragma once

#include <puppetwarp/diff/compare.h>

#include <string>

namespace puppetwarp {

//! What a comparison says to a person: a line with the verdict, then, where anything differs, lines with the figures in
//! the words of OpenImageIO's `idiff`. Each line ends in a line feed.
std::string summary(const Comparison& comparison);

}  // namespace puppetwarp
