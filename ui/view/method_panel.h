#pragma once

#include "model/editor.h"

namespace puppetwarp::ui {

//! The choice of the method, what it is for, and its options; each change is one step of the history.
void draw_method_panel(Editor& editor);

}  // namespace puppetwarp::ui
