#pragma once

#include "model/editor.h"
#include "view/actions.h"
#include "view/canvas.h"
#include "view/theme.h"

namespace puppetwarp::ui {

//! Menu, toolbar, side panel and status line. \return what they leave for the canvas.
ScreenRect draw_panels(Editor& editor, Canvas& canvas, const ActionTable& actions, const Fonts& fonts, float scale);

//! The canvas with its hints, or the welcome while nothing is open.
void draw_canvas_window(Editor& editor, Canvas& canvas, const ActionTable& actions, const Fonts& fonts, float scale);

//! What the pointer and the keys do.
void draw_help(const ActionTable& actions, const Fonts& fonts, float scale, bool& open);

}  // namespace puppetwarp::ui
