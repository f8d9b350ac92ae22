#pragma once
// Private header: JSON does not appear in the installed ones.

#include <puppetwarp/project/json_reader.h>

#include <string>

namespace puppetwarp {

//! The first thing in which a document does not agree with a JSON Schema: where it stands and what is wrong, such as
//! `mesh.min_angle_deg must be at most 30`; empty when all agrees.
//! \param schema  of draft 2020-12, with the keywords that `puppet_schema` uses.
//! \throw std::logic_error  another keyword: nothing is passed over in silence.
std::string schema_fault(const Json& document, const Json& schema);

}  // namespace puppetwarp
