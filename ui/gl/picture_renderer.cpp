#include "gl/picture_renderer.h"

#include <puppetwarp/base/errors.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace puppetwarp::ui {

namespace {

// A place in image space and in the texture, [0, 1].
struct Vertex {
    float x, y, u, v;
};

constexpr GLsizei rectangle_vertices = 6;

enum Mode { textured = 0, flat = 1, checkerboard = 2, wire = 3 };

constexpr const char* vertex_source = R"(#version 330 core
layout(location = 0) in vec2 image_point;
layout(location = 1) in vec2 texture_point;
uniform vec4 view;  // scale and shift, from image space to clip space
out vec2 uv;
out vec3 corner;
void main() {
    uv = texture_point;
    int k = gl_VertexID % 3;  // triangles share no vertices here
    corner = vec3(k == 0, k == 1, k == 2);
    gl_Position = vec4(image_point * view.xy + view.zw, 0.0, 1.0);
})";

constexpr const char* fragment_source = R"(#version 330 core
in vec2 uv;
in vec3 corner;
uniform int mode;
uniform vec4 colour;  // premultiplied
uniform float line_px;
uniform sampler2D picture;
out vec4 result;
void main() {
    if (mode == 0) {
        // The grown mesh reaches past the picture, where there is nothing.
        if (any(lessThan(uv, vec2(0.0))) || any(greaterThan(uv, vec2(1.0)))) discard;
        result = texture(picture, uv);
    } else if (mode == 1) {
        result = colour;
    } else if (mode == 2) {
        ivec2 square = ivec2(floor(gl_FragCoord.xy / line_px));
        result = vec4(vec3((square.x + square.y) % 2 == 0 ? 0.235 : 0.275), 1.0);
    } else {
        // Each triangle draws its half of an edge's line, soft over one pixel.
        vec3 pixels = corner / fwidth(corner);
        float distance = min(min(pixels.x, pixels.y), pixels.z);
        result = colour * clamp(line_px * 0.5 + 0.5 - distance, 0.0, 1.0);
    }
})";

GlShader compile(GLenum kind, const char* source) {
    GlShader shader(glCreateShader(kind));
    glShaderSource(shader.get(), 1, &source, nullptr);
    glCompileShader(shader.get());
    GLint ok = GL_FALSE;
    glGetShaderiv(shader.get(), GL_COMPILE_STATUS, &ok);
    if (ok == GL_TRUE) return shader;
    char log[512] = "";
    glGetShaderInfoLog(shader.get(), sizeof log, nullptr, log);
    throw MachineFault("OpenGL", std::string("cannot compile a shader: ") + log, "update the graphics driver");
}

GlProgram link_program() {
    const GlShader vertex = compile(GL_VERTEX_SHADER, vertex_source);
    const GlShader fragment = compile(GL_FRAGMENT_SHADER, fragment_source);
    GlProgram program(glCreateProgram());
    glAttachShader(program.get(), vertex.get());
    glAttachShader(program.get(), fragment.get());
    glLinkProgram(program.get());
    GLint ok = GL_FALSE;
    glGetProgramiv(program.get(), GL_LINK_STATUS, &ok);
    if (ok != GL_TRUE) throw MachineFault("OpenGL", "cannot link a shader", "update the graphics driver");
    return program;
}

GlTexture make_texture(const cv::Mat& rgba) {
    GLuint name = 0;
    glGenTextures(1, &name);
    GlTexture texture(name);
    glBindTexture(GL_TEXTURE_2D, name);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
    glPixelStorei(GL_UNPACK_ROW_LENGTH, static_cast<GLint>(rgba.step[0] / 4));
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, rgba.cols, rgba.rows, 0, GL_RGBA, GL_UNSIGNED_BYTE, rgba.data);
    glPixelStorei(GL_UNPACK_ROW_LENGTH, 0);
    glGenerateMipmap(GL_TEXTURE_2D);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    return texture;
}

// The rectangle of the picture first, then the triangles in the order in which they are painted.
std::vector<Vertex> all_vertices(const Shape& shape) {
    const auto width = static_cast<float>(shape.subject->image.width());
    const auto height = static_cast<float>(shape.subject->image.height());
    std::vector<Vertex> vertices{{0, 0, 0, 0}, {width, 0, 1, 0},      {width, height, 1, 1},
                                 {0, 0, 0, 0}, {width, height, 1, 1}, {0, height, 0, 1}};
    if (!shape.mesh) return vertices;
    const TriangleMesh& mesh = *shape.mesh;
    vertices.reserve(vertices.size() + 3 * static_cast<std::size_t>(mesh.F.rows()));
    for (Eigen::Index place = 0; place < mesh.F.rows(); ++place) {
        const Eigen::Index t = shape.order.size() > 0 ? shape.order(place) : place;
        for (int k = 0; k < 3; ++k) {
            const int i = mesh.F(t, k);
            vertices.push_back({static_cast<float>(shape.moved(i, 0)), static_cast<float>(shape.moved(i, 1)),
                                static_cast<float>(mesh.V(i, 0)) / width, static_cast<float>(mesh.V(i, 1)) / height});
        }
    }
    return vertices;
}

}  // namespace

int longest_texture_side() {
    GLint limit = 0;
    glGetIntegerv(GL_MAX_TEXTURE_SIZE, &limit);
    return std::clamp(static_cast<int>(limit), 1024, 8192);
}

PictureRenderer::PictureRenderer() : program_(link_program()) {
    view_location_ = glGetUniformLocation(program_.get(), "view");
    mode_location_ = glGetUniformLocation(program_.get(), "mode");
    colour_location_ = glGetUniformLocation(program_.get(), "colour");
    line_location_ = glGetUniformLocation(program_.get(), "line_px");
    GLuint name = 0;
    glGenVertexArrays(1, &name);
    vertex_array_ = GlVertexArray(name);
    glGenBuffers(1, &name);
    vertices_ = GlBuffer(name);
    glBindVertexArray(vertex_array_.get());
    glBindBuffer(GL_ARRAY_BUFFER, vertices_.get());
    glVertexAttribPointer(0, 2, GL_FLOAT, GL_FALSE, sizeof(Vertex), nullptr);
    glVertexAttribPointer(1, 2, GL_FLOAT, GL_FALSE, sizeof(Vertex), reinterpret_cast<const void*>(2 * sizeof(float)));
    glEnableVertexAttribArray(0);
    glEnableVertexAttribArray(1);
}

void PictureRenderer::upload(const std::shared_ptr<const Shape>& shape) {
    if (shape == shape_) return;
    if (shape->subject != subject_) {
        subject_texture_ = make_texture(shape->subject->shown_subject);
        picture_texture_ = GlTexture();
        const bool same = shape->subject->shown_picture.data == shape->subject->shown_subject.data;
        if (!same) picture_texture_ = make_texture(shape->subject->shown_picture);
        const bool filled = !shape->subject->shown_filled.empty();
        filled_texture_ = filled ? make_texture(shape->subject->shown_filled) : GlTexture();
        subject_ = shape->subject;
    }
    const std::vector<Vertex> vertices = all_vertices(*shape);
    mesh_vertices_ = static_cast<GLsizei>(vertices.size()) - rectangle_vertices;
    glBindBuffer(GL_ARRAY_BUFFER, vertices_.get());
    glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(vertices.size() * sizeof(Vertex)), vertices.data(),
                 GL_STREAM_DRAW);
    shape_ = shape;
}

void PictureRenderer::draw(const Frame& frame, const std::shared_ptr<const Shape>& shape) {
    if (!shape || !shape->subject) return;
    upload(shape);
    const double dpi = frame.pixels_per_point;
    const Point corner = frame.viewport.min * dpi;
    const Point size = frame.viewport.size * dpi;
    glEnable(GL_SCISSOR_TEST);
    glScissor(static_cast<GLint>(corner.x()), static_cast<GLint>(frame.window_size.y() * dpi - corner.y() - size.y()),
              static_cast<GLsizei>(size.x()), static_cast<GLsizei>(size.y()));
    glEnable(GL_BLEND);
    glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
    glDisable(GL_CULL_FACE);
    glUseProgram(program_.get());
    glBindVertexArray(vertex_array_.get());
    glActiveTexture(GL_TEXTURE0);
    const Point origin = frame.view.screen_from_image({0, 0});
    const Point clip_scale(2 / frame.window_size.x(), -2 / frame.window_size.y());
    glUniform4f(view_location_, static_cast<float>(frame.view.scale() * clip_scale.x()),
                static_cast<float>(frame.view.scale() * clip_scale.y()),
                static_cast<float>(origin.x() * clip_scale.x() - 1),
                static_cast<float>(origin.y() * clip_scale.y() + 1));

    glUniform1f(line_location_, static_cast<float>(10 * dpi));
    draw_part(checkerboard, 0, rectangle_vertices);
    const auto& colour = frame.background;
    if (colour[3] > 0) {
        set_colour(colour);
        draw_part(flat, 0, rectangle_vertices);
    }
    glBindTexture(GL_TEXTURE_2D, (picture_texture_ ? picture_texture_ : subject_texture_).get());
    if (frame.keep_picture || mesh_vertices_ == 0) draw_part(textured, 0, rectangle_vertices);
    if (frame.fill_picture && filled_texture_ && mesh_vertices_ > 0) {
        glBindTexture(GL_TEXTURE_2D, filled_texture_.get());
        draw_part(textured, 0, rectangle_vertices);
    }
    if (mesh_vertices_ > 0) {
        // As the command does it: turned-over triangles are drawn on demand. The y axis points down, hence clockwise.
        if (!frame.back_faces) glEnable(GL_CULL_FACE);
        glFrontFace(GL_CW);
        glBindTexture(GL_TEXTURE_2D, subject_texture_.get());
        draw_part(textured, rectangle_vertices, mesh_vertices_);
        glDisable(GL_CULL_FACE);
    }
    if (frame.show_mesh && mesh_vertices_ > 0) {
        // Light on dark, to be seen on any picture.
        glUniform1f(line_location_, static_cast<float>(2.5 * dpi));
        set_colour({0, 0, 0, 0.22});
        draw_part(wire, rectangle_vertices, mesh_vertices_);
        glUniform1f(line_location_, static_cast<float>(dpi));
        set_colour({1, 1, 1, 0.45});
        draw_part(wire, rectangle_vertices, mesh_vertices_);
    }
    glDisable(GL_SCISSOR_TEST);
}

void PictureRenderer::set_colour(const std::array<double, 4>& straight) {
    const auto alpha = static_cast<float>(straight[3]);
    glUniform4f(colour_location_, static_cast<float>(straight[0]) * alpha, static_cast<float>(straight[1]) * alpha,
                static_cast<float>(straight[2]) * alpha, alpha);
}

void PictureRenderer::draw_part(int mode, GLint first, GLsizei count) {
    glUniform1i(mode_location_, mode);
    glDrawArrays(GL_TRIANGLES, first, count);
}

}  // namespace puppetwarp::ui
