// The names in an attached model, which its <attach> lengthens.
#pragma once

#include <pugixml.hpp>
#include <string>

namespace manyhands::io {

/// Puts the prefix before all names, and before all references to them, in a file of an attached model. Parts that are
/// named by their file, and the main default class, get names of their own first.
void add_prefix(const std::string& prefix, pugi::xml_node root);

}  // namespace manyhands::io
