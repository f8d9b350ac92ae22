#pragma once

#include <memory>
#include <string>
#include <string_view>

#include <vips/vips.h>

namespace puppetwarp {

struct GObjectDeleter {
    void operator()(gpointer object) const { g_object_unref(object); }
};
template <typename T>
using GObjectPtr = std::unique_ptr<T, GObjectDeleter>;

using VipsImagePtr = GObjectPtr<VipsImage>;
using VipsSourcePtr = GObjectPtr<VipsSource>;
using VipsTargetPtr = GObjectPtr<VipsTarget>;

//! Makes libvips ready, once a process (and its error text empty, each time): silent, without operation cache, and with
//! none but the loaders of plain pictures (documents, scripts and laboratory formats stay blocked, process-wide). Its
//! worker threads follow `thread_count()`. \throw MachineFault  libvips does not start.
void require_vips();

//! Whether a loader, by its class name, is one of those.
bool is_allowed_loader(std::string_view class_name);

//! Takes libvips' error text, as one line without the names of its internals; empty when there is none.
std::string take_vips_error();

}  // namespace puppetwarp
