#pragma once

#include <puppetwarp/base/image.h>

#include <string>
#include <vector>

//! The pictures that this project draws itself, each with a puppet file beside it.
namespace samples {

puppetwarp::Image draw_gingerbread();  //!< 8-bit RGB + alpha: a plump shape with short limbs
puppetwarp::Image draw_figure();       //!< 8-bit RGB + alpha: limbs on joints, away from the body
puppetwarp::Image draw_ring();         //!< 8-bit RGB + alpha: a pretzel, three holes
puppetwarp::Image draw_tail();         //!< 8-bit RGB + alpha: a cat with a long thin tail and a soft shadow
puppetwarp::Image draw_photo();        //!< 8-bit RGB: a pear on a table, as a camera would see it
puppetwarp::Image draw_jellyfish();    //!< 16-bit RGB + alpha: translucent all over

struct Sample {
    std::string name;  //!< of the files: NAME.png, NAME.puppet.json
    puppetwarp::Image (*draw)();
};
const std::vector<Sample>& all_samples();

}  // namespace samples
