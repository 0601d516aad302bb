// solref and solimp: what gives way as it does in MuJoCo.
#pragma once

#include <optional>

#include "manyhands/model/compliance.h"
#include "manyhands/model/io/mjcf/mjcf_element.h"
#include "manyhands/model/io/mjcf/mjcf_writer.h"

namespace manyhands::io {

/// What two attributes of an element ("solref" and "solimp" as they are called there) say, their classes included.
/// With kStated none unless it is clearly softer than MuJoCo's default (`is_soft`), and then it is noted as not used.
[[nodiscard]] std::optional<Compliance> read_compliance(const MjcfElement& e, MjcfCompliance taken, const char* solref,
                                                        const char* solimp);

/// The same of a geom. What it states counts in its mean with others, which decides: `Compliance::if_soft`.
[[nodiscard]] std::optional<Compliance> read_surface_compliance(const MjcfElement& e, MjcfCompliance taken);

/// Writes both, if there is a compliance: as a time constant and ratio of damping where these are read back as they
/// were, else as stiffness and damping. `what` is the part in notes.
void write_compliance(MjcfWriter& writer, pugi::xml_node node, const std::string& what,
                      const std::optional<Compliance>& compliance, const char* solref, const char* solimp);

}  // namespace manyhands::io
