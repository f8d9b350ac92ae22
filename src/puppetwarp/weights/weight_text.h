#pragma once

#include <puppetwarp/weights/weights.h>

#include <string>
#include <vector>

namespace puppetwarp {

//! Names of the columns that `weights_csv` and `weights_dmat` write: `column_name`; of complex weights the real part of
//! each column as `NAME.re`, then the imaginary one as `NAME.im`.
std::vector<std::string> weight_headers(const Rig& rig, const Weights& weights);

//! Comma-separated values: a header of `weight_headers`, quoted where that is needed (RFC 4180), then one row a vertex,
//! 17 significant digits, no index column.
std::string weights_csv(const Rig& rig, const Weights& weights);

//! The text form of libigl's dense matrices: the number of columns and of rows, then all values column by column, one a
//! line, 17 significant digits. The columns of `weights_csv`.
std::string weights_dmat(const Weights& weights);

//! What a person should hear of weights: what they warn of, which fallback finished them, that they did not converge.
std::vector<std::string> weight_warnings(const Weights& weights);

}  // namespace puppetwarp
