#pragma once

#include <imgui.h>

namespace puppetwarp::ui {

//! The colours that more than one part of the window uses.
namespace colours {
inline const ImVec4 canvas{0.110f, 0.114f, 0.125f, 1};
inline const ImVec4 panel{0.149f, 0.153f, 0.169f, 1};
inline const ImVec4 line{0.224f, 0.231f, 0.255f, 1};
inline const ImVec4 text{0.871f, 0.882f, 0.902f, 1};
inline const ImVec4 dim_text{0.553f, 0.573f, 0.612f, 1};
inline const ImVec4 accent{0.298f, 0.608f, 0.949f, 1};
inline const ImVec4 pin{1.000f, 0.757f, 0.271f, 1};
inline const ImVec4 error{0.973f, 0.443f, 0.443f, 1};
inline const ImVec4 warning{1.000f, 0.757f, 0.271f, 1};
inline const ImVec4 good{0.486f, 0.784f, 0.533f, 1};
}  // namespace colours

//! The fonts, all from one family.
struct Fonts {
    ImFont* regular = nullptr;
    ImFont* title = nullptr;
};

//! Sets colours, spacing and fonts of the current ImGui context.
//! \param scale  points for one unit of the design; 2 on a screen of high resolution.
Fonts apply_theme(float scale);

}  // namespace puppetwarp::ui
