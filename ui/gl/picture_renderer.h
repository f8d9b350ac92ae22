#pragma once

#include "gl/gl_objects.h"
#include "model/shape.h"
#include "model/view_transform.h"

#include <array>
#include <memory>

namespace puppetwarp::ui {

//! The longest side that a texture of this OpenGL context may have, kept within what a screen can use.
int longest_texture_side();

//! Draws the moved picture, what stands behind it, and its triangles.
class PictureRenderer {
public:
    struct Frame {
        ScreenRect viewport;          //!< of the canvas, window coordinates
        Point window_size;            //!< window coordinates
        double pixels_per_point = 1;  //!< of the framebuffer
        ViewTransform view;
        bool show_mesh = false;
        bool back_faces = false;                       //!< triangles that are turned over are drawn too
        bool keep_picture = false;                     //!< the picture itself stands behind
        bool fill_picture = false;                     //!< the picture without its subject stands behind
        std::array<double, 4> background{0, 0, 0, 0};  //!< colour behind, straight alpha
    };

    //! \throw MachineFault  the driver refuses the shaders.
    PictureRenderer();

    //! Draws into the current framebuffer, within the viewport. `shape` may be null.
    void draw(const Frame& frame, const std::shared_ptr<const Shape>& shape);

private:
    void upload(const std::shared_ptr<const Shape>& shape);
    void set_colour(const std::array<double, 4>& straight);
    void draw_part(int mode, GLint first, GLsizei count);

    GlProgram program_;
    GLint view_location_ = -1;
    GLint mode_location_ = -1;
    GLint colour_location_ = -1;
    GLint line_location_ = -1;
    GlVertexArray vertex_array_;
    GlBuffer vertices_;
    GLsizei mesh_vertices_ = 0;
    GlTexture subject_texture_;
    GlTexture picture_texture_;
    GlTexture filled_texture_;
    std::shared_ptr<const Subject> subject_;
    std::shared_ptr<const Shape> shape_;
};

}  // namespace puppetwarp::ui
