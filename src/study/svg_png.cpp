// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/svg_png.hpp"

#include <cairo.h>
#include <librsvg/rsvg.h>

#include <chrono>
#include <cmath>
#include <memory>
#include <system_error>
#include <thread>

#include "files/checked_file.hpp"
#include "files/memory_at_hand.hpp"
#include "files/threads_at_hand.hpp"

namespace tubefoot {
namespace {

/// Throws std::system_error if no thread can start within the time limit.
GThread* started(const gchar* name, GThreadFunc work, gpointer data) {
  constexpr std::chrono::milliseconds pause(2);
  constexpr std::chrono::seconds patience(10);
  const auto begin = std::chrono::steady_clock::now();
  for (;;) {
    if (GThread* const thread = g_thread_try_new(name, work, data, nullptr)) return thread;
    if (std::chrono::steady_clock::now() - begin > patience)
      throw std::system_error(std::make_error_code(std::errc::resource_unavailable_try_again));
    std::this_thread::sleep_for(pause);
  }
}

}  // namespace

// Replaces g_thread_new() of GLib, which terminates the program with a signal if the thread cannot start.
// The dynamic linker prefers this definition (CMakeLists.txt in this folder). Pango 1.50 starts two threads
// for each font, which end after they find the font. The number of fonts of a text is unknown. Pango 1.56
// starts one thread. One free thread therefore suffices if this function waits for it. If none becomes
// free, the handler of std::terminate reports it (run/console/exhausted.hpp).
extern "C" __attribute__((visibility("default"), used)) GThread* g_thread_new(const gchar* name,
                                                                              GThreadFunc work,
                                                                              gpointer data) noexcept {
  return started(name, work, data);
}

void write_png_of_svg(const std::string& svg, const std::filesystem::path& file, double scale) {
  const auto fail = [&](const std::string& why) {
    throw write_error(file, "cannot draw the picture: " + why);
  };
  // GLib terminates the program if an allocation fails or if no thread can start.
  require_addresses(std::size_t{256} << 20);
  require_threads(1);
  GError* error = nullptr;
  const std::unique_ptr<RsvgHandle, void (*)(gpointer)> handle(
      rsvg_handle_new_from_data(reinterpret_cast<const guint8*>(svg.data()), svg.size(), &error),
      g_object_unref);
  const auto message = [&] {
    std::string text = error != nullptr ? error->message : "no reason given";
    g_clear_error(&error);
    return text;
  };
  if (!handle) fail(message());
  gdouble width = 0, height = 0;
  if (!rsvg_handle_get_intrinsic_size_in_pixels(handle.get(), &width, &height))
    fail("the drawing has no size");
  const std::unique_ptr<cairo_surface_t, void (*)(cairo_surface_t*)> surface(
      cairo_image_surface_create(CAIRO_FORMAT_RGB24, static_cast<int>(std::lround(width * scale)),
                                 static_cast<int>(std::lround(height * scale))),
      cairo_surface_destroy);
  const std::unique_ptr<cairo_t, void (*)(cairo_t*)> cairo(cairo_create(surface.get()), cairo_destroy);
  cairo_scale(cairo.get(), scale, scale);
  const RsvgRectangle viewport{0, 0, width, height};
  if (!rsvg_handle_render_document(handle.get(), cairo.get(), &viewport, &error)) fail(message());
  std::string bytes;
  const auto take = [](void* to, const unsigned char* data, unsigned int count) {
    static_cast<std::string*>(to)->append(reinterpret_cast<const char*>(data), count);
    return CAIRO_STATUS_SUCCESS;
  };
  if (const cairo_status_t status = cairo_surface_write_to_png_stream(surface.get(), take, &bytes);
      status != CAIRO_STATUS_SUCCESS)
    fail(cairo_status_to_string(status));
  write_file(file, bytes);
}

}  // namespace tubefoot
