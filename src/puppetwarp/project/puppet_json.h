#pragma once
// Private header: JSON does not appear in the installed ones.

#include <puppetwarp/project/json_reader.h>
#include <puppetwarp/project/puppet.h>

namespace puppetwarp {

//! The puppet that a document describes. \throw InvalidInput  names the field that is wrong.
Puppet puppet_from_json(const JsonReader& document);

//! `puppet_schema`, parsed.
Json json_of_puppet_schema();

//! The document that describes a puppet: known keys in their order, then those of `puppet.source` that are unknown.
Json json_from_puppet(const Puppet& puppet);

}  // namespace puppetwarp
