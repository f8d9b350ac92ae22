#include <puppetwarp/weights/weight_text.h>

#include <array>
#include <cstdio>

namespace puppetwarp {

namespace {

void append_number(std::string& text, double value, char end) {
    std::array<char, 32> digits{};
    std::snprintf(digits.data(), digits.size(), "%.17g", value);
    text += digits.data();
    text += end;
}

std::string quoted(const std::string& name) {
    if (name.find_first_of(",\"\r\n") == std::string::npos) return name;
    std::string text = "\"";
    for (const char c : name) {
        if (c == '"') text += '"';
        text += c;
    }
    return text + '"';
}

// Real and imaginary columns side by side.
Eigen::MatrixXd written_columns(const Weights& weights) {
    if (weights.W_imaginary.size() == 0) return weights.W;
    Eigen::MatrixXd all(weights.W.rows(), 2 * weights.W.cols());
    for (Eigen::Index c = 0; c < weights.W.cols(); ++c) {
        all.col(2 * c) = weights.W.col(c);
        all.col(2 * c + 1) = weights.W_imaginary.col(c);
    }
    return all;
}

}  // namespace

std::vector<std::string> weight_headers(const Rig& rig, const Weights& weights) {
    std::vector<std::string> headers;
    for (const WeightColumn& column : weights.columns) {
        const std::string name = column_name(rig, column);
        if (weights.W_imaginary.size() == 0) {
            headers.push_back(name);
        } else {
            headers.push_back(name + ".re");
            headers.push_back(name + ".im");
        }
    }
    return headers;
}

std::string weights_csv(const Rig& rig, const Weights& weights) {
    std::string text;
    for (const std::string& header : weight_headers(rig, weights)) text += (text.empty() ? "" : ",") + quoted(header);
    text += '\n';
    const Eigen::MatrixXd columns = written_columns(weights);
    for (Eigen::Index v = 0; v < columns.rows(); ++v) {
        for (Eigen::Index c = 0; c < columns.cols(); ++c) {
            append_number(text, columns(v, c), c + 1 < columns.cols() ? ',' : '\n');
        }
    }
    return text;
}

std::string weights_dmat(const Weights& weights) {
    const Eigen::MatrixXd columns = written_columns(weights);
    std::string text = std::to_string(columns.cols()) + ' ' + std::to_string(columns.rows()) + '\n';
    for (Eigen::Index i = 0; i < columns.size(); ++i) append_number(text, columns.data()[i], '\n');
    return text;
}

std::vector<std::string> weight_warnings(const Weights& weights) {
    std::vector<std::string> warnings = weights.warnings;
    if (!weights.fallback.empty()) warnings.push_back("the weights were finished by " + weights.fallback);
    if (!weights.converged) {
        std::array<char, 128> text{};
        std::snprintf(text.data(), text.size(), "the weights did not converge: KKT residual %.2g after %d iterations",
                      weights.kkt_residual, weights.iterations);
        warnings.emplace_back(text.data());
    }
    return warnings;
}

}  // namespace puppetwarp
