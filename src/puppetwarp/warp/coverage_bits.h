#pragma once

#include <puppetwarp/warp/spans.h>

#include <algorithm>
#include <cstdint>
#include <vector>

namespace puppetwarp::detail {

//! One bit a pixel: what triangles have covered of a few rows.
class CoverageBits {
public:
    CoverageBits(RowRange rows, int width)
        : first_row_(rows.first),
          width_(width),
          words_a_row_((static_cast<std::size_t>(width) + 63) / 64),
          words_(words_a_row_ * static_cast<std::size_t>(rows.last - rows.first)) {}

    //! \return whether some pixel of [first, last) was covered before.
    bool add(int row, int first, int last) {
        std::uint64_t* words = words_.data() + words_a_row_ * static_cast<std::size_t>(row - first_row_);
        const auto head = static_cast<std::size_t>(first) / 64, tail = static_cast<std::size_t>(last - 1) / 64;
        const std::uint64_t from_first = ~std::uint64_t{0} << (first % 64);
        const std::uint64_t to_last = ~std::uint64_t{0} >> (63 - (last - 1) % 64);
        if (head == tail) return add_word(words[head], from_first & to_last);
        bool before = add_word(words[head], from_first);
        for (std::size_t i = head + 1; i < tail; ++i) before |= add_word(words[i], ~std::uint64_t{0});
        return add_word(words[tail], to_last) || before;
    }

    //! `body(first, last)` for what is not covered of a row.
    template <class Body>
    void for_each_gap(int row, const Body& body) const {
        const std::uint64_t* words = words_.data() + words_a_row_ * static_cast<std::size_t>(row - first_row_);
        int first = 0;
        while (true) {
            first = next(words, first, 0);
            if (first >= width_) return;
            const int last = next(words, first, ~std::uint64_t{0});
            body(first, last);
            first = last;
        }
    }

private:
    static bool add_word(std::uint64_t& word, std::uint64_t bits) {
        const bool before = (word & bits) != 0;
        word |= bits;
        return before;
    }

    // The first pixel from `x` on that is not covered (`flip` 0) or covered (all ones).
    int next(const std::uint64_t* words, int x, std::uint64_t flip) const {
        while (x < width_) {
            // Bits that are looked for are ones here.
            const std::uint64_t found = ~(words[x / 64] ^ flip) >> (x % 64);
            if (found != 0) return std::min(width_, x + __builtin_ctzll(found));
            x = (x / 64 + 1) * 64;
        }
        return width_;
    }

    int first_row_;
    int width_;
    std::size_t words_a_row_;
    std::vector<std::uint64_t> words_;
};

}  // namespace puppetwarp::detail
