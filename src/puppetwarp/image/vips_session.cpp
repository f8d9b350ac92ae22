#include <puppetwarp/image/vips_session.h>

#include <puppetwarp/base/errors.h>
#include <puppetwarp/base/threads.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <mutex>
#include <sstream>

namespace puppetwarp {

namespace {

// What reads plain pictures. All else is blocked: what libvips marks as meant for documents, scripts, vector graphics
// and microscopes has no business in front of a stranger's file; libjxl prints on standard error, past every handler;
// and OpenEXR files are read by OpenEXR itself.
constexpr std::array<const char*, 9> allowed_loaders = {
    "VipsForeignLoadPng",  "VipsForeignLoadJpeg", "VipsForeignLoadTiff", "VipsForeignLoadWebp", "VipsForeignLoadNsgif",
    "VipsForeignLoadHeif", "VipsForeignLoadJp2k", "VipsForeignLoadPpm",  "VipsForeignLoadRad"};

void swallow(const gchar*, GLogLevelFlags, const gchar*, gpointer) {}

void start() {
    // A library must not print; libvips and what it stands on warn through GLib.
    constexpr auto levels = static_cast<GLogLevelFlags>(static_cast<int>(G_LOG_LEVEL_MASK) & ~G_LOG_LEVEL_ERROR);
    for (const char* domain : {"VIPS", "GLib", "GLib-GObject", "GLib-GIO"})
        g_log_set_handler(domain, levels, swallow, nullptr);
    g_log_set_handler(nullptr, levels, swallow, nullptr);
    g_log_set_default_handler(swallow, nullptr);
    if (vips_init("puppetwarp") != 0) throw MachineFault("libvips", "does not start: " + take_vips_error());
    // A file that changed must never meet the pixels it had before.
    vips_cache_set_max(0);
    vips_operation_block_set("VipsForeignLoad", TRUE);
    for (const char* loader : allowed_loaders) vips_operation_block_set(loader, FALSE);
}

// "pngload_source: libpng read error" -> "libpng read error": the first word names an operation of libvips.
std::string without_domain(const std::string& line) {
    const std::size_t colon = line.find(": ");
    const bool one_word = colon != std::string::npos && line.find(' ') > colon;
    return one_word ? line.substr(colon + 2) : line;
}

std::string trimmed(std::string line) {
    const auto visible = [](unsigned char c) { return std::isgraph(c) != 0; };
    line.erase(line.begin(), std::find_if(line.begin(), line.end(), visible));
    line.erase(std::find_if(line.rbegin(), line.rend(), visible).base(), line.end());
    return line;
}

}  // namespace

void require_vips() {
    static std::once_flag once;
    std::call_once(once, start);
    vips_concurrency_set(thread_count());
    vips_error_clear();  // of what came before: some warnings of a picture that was read stay behind
}

bool is_allowed_loader(std::string_view class_name) {
    return std::any_of(allowed_loaders.begin(), allowed_loaders.end(),
                       [&](const char* loader) { return class_name.starts_with(loader); });
}

std::string take_vips_error() {
    gchar* text = vips_error_buffer_copy();
    std::istringstream lines(text);
    g_free(text);
    std::string line;
    std::string reason;
    // The first line is the cause, what follows are its consequences.
    while (reason.empty() && std::getline(lines, line)) reason = trimmed(without_domain(trimmed(line)));
    return reason;
}

}  // namespace puppetwarp
