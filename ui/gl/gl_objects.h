#pragma once

#include <epoxy/gl.h>

#include <utility>

namespace puppetwarp::ui {

//! Owns one OpenGL name. Needs the context that made it while it lives.
template <void (*Delete)(GLuint)>
class GlObject {
public:
    GlObject() = default;
    explicit GlObject(GLuint name) : name_(name) {}
    GlObject(GlObject&& other) noexcept : name_(std::exchange(other.name_, 0)) {}
    GlObject& operator=(GlObject&& other) noexcept {
        std::swap(name_, other.name_);
        return *this;
    }
    ~GlObject() {
        if (name_) Delete(name_);
    }
    GLuint get() const { return name_; }
    explicit operator bool() const { return name_ != 0; }

private:
    GLuint name_ = 0;
};

inline void delete_texture(GLuint name) {
    glDeleteTextures(1, &name);
}
inline void delete_buffer(GLuint name) {
    glDeleteBuffers(1, &name);
}
inline void delete_vertex_array(GLuint name) {
    glDeleteVertexArrays(1, &name);
}
inline void delete_shader(GLuint name) {
    glDeleteShader(name);
}
inline void delete_program(GLuint name) {
    glDeleteProgram(name);
}

using GlTexture = GlObject<delete_texture>;
using GlBuffer = GlObject<delete_buffer>;
using GlVertexArray = GlObject<delete_vertex_array>;
using GlShader = GlObject<delete_shader>;
using GlProgram = GlObject<delete_program>;

}  // namespace puppetwarp::ui
