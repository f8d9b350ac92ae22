// draw_samples [FOLDER [NAME...]]: draws the project's own pictures as PNG into a folder, by default this one.

#include "samples.h"

#include <puppetwarp/image/write.h>

#include <algorithm>
#include <exception>
#include <filesystem>
#include <iostream>

int main(int argc, char** argv) {
    try {
        const std::vector<std::string> arguments(argv + 1, argv + argc);
        const std::filesystem::path folder = arguments.empty() ? PUPPETWARP_IMAGES_DIR : arguments[0];
        for (const auto& [name, draw] : samples::all_samples()) {
            const bool wanted =
                arguments.size() < 2 || std::find(arguments.begin() + 1, arguments.end(), name) != arguments.end();
            if (wanted) puppetwarp::write_image(draw(), folder / (name + ".png"), {.compression = 9});
        }
        return 0;
    } catch (const std::exception& error) {
        std::cerr << "draw_samples: " << error.what() << '\n';
        return 3;
    }
}
