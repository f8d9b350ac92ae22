#pragma once

#include <string>

namespace puppetwarp {

//! The JSON Schema (draft 2020-12) of the puppet file, version 1: every key with its meaning, unit and range, indented
//! text with a final newline. `read_puppet` checks what it has read against it, so a file that is read is valid. A
//! valid file is read unless it contradicts itself in what a schema cannot say: ids used twice, parents in a loop,
//! poses of handles that are not there or have no such field, a bone without length.
std::string puppet_schema();

}  // namespace puppetwarp
