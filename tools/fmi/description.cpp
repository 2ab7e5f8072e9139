#include "tools/fmi/description.h"

#include "core/text/parse.h"

namespace photorque {
namespace {

std::string escaped_attribute(const std::string& text) {
  std::string safe;
  for (const char c : text) {
    switch (c) {
      case '&':
        safe += "&amp;";
        break;
      case '<':
        safe += "&lt;";
        break;
      case '>':
        safe += "&gt;";
        break;
      case '"':
        safe += "&quot;";
        break;
      default:
        safe += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
    }
  }
  return safe;
}

// Attributes in the order in which they are given.
struct Element {
  std::string text;
  explicit Element(const std::string& name) : text("<" + name) {}
  Element& set(const std::string& name, const std::string& value) {
    text += " " + name + "=\"" + escaped_attribute(value) + "\"";
    return *this;
  }
  Element& set(const std::string& name, double value) { return set(name, shortest(value)); }
  std::string line(const std::string& indent) const { return indent + text + "/>\n"; }
};

constexpr const char* unit_definitions = R"(  <UnitDefinitions>
    <Unit name="s"><BaseUnit s="1"/></Unit>
    <Unit name="rad"><BaseUnit rad="1"/><DisplayUnit name="deg" factor="57.29577951308232"/></Unit>
    <Unit name="rad/s"><BaseUnit s="-1" rad="1"/><DisplayUnit name="deg/s" factor="57.29577951308232"/></Unit>
    <Unit name="N.m"><BaseUnit kg="1" m="2" s="-2"/></Unit>
    <Unit name="A"><BaseUnit A="1"/></Unit>
    <Unit name="W"><BaseUnit kg="1" m="2" s="-3"/></Unit>
  </UnitDefinitions>
)";

constexpr const char* log_categories = R"(  <LogCategories>
    <Category name="logEvents" description="what the run says"/>
    <Category name="logStatusDiscard" description="values that were refused"/>
    <Category name="logStatusError" description="what went wrong"/>
  </LogCategories>
)";

std::string variable_line(const UnitVariable& variable, const UnitDescription& unit) {
  using Kind = UnitVariable::Kind;
  Element element(variable.kind == Kind::flag ? "Boolean" : "Float64");
  element.set("name", variable.name).set("valueReference", std::to_string(variable.reference));
  element.set("description", variable.meaning);
  if (variable.kind == Kind::time) {
    element.set("causality", "independent").set("variability", "continuous");
  } else if (variable.kind == Kind::input) {
    element.set("causality", "input").set("variability", "continuous");
  } else {
    element.set("causality", "output");
    element.set("variability", variable.kind == Kind::flag ? "discrete" : "continuous");
    element.set("initial", "calculated");
  }
  if (!variable.unit.empty()) element.set("unit", variable.unit);
  if (variable.kind == Kind::input) {
    element.set("min", -unit.max_torque_N_m).set("max", unit.max_torque_N_m).set("start", 0.0);
  }
  return element.line("    ");
}

// Nothing that comes out at a tick depends on what goes in at it.
std::string structure_lines(const UnitDescription& unit) {
  std::string lines;
  for (const char* name : {"Output", "InitialUnknown"}) {
    for (const UnitVariable& variable : unit.variables) {
      if (variable.kind != UnitVariable::Kind::output &&
          variable.kind != UnitVariable::Kind::flag) {
        continue;
      }
      lines += Element(name)
                   .set("valueReference", std::to_string(variable.reference))
                   .set("dependencies", "")
                   .line("    ");
    }
  }
  return lines;
}

}  // namespace

std::string model_description(const UnitDescription& unit, const std::string& name,
                              const std::string& token, const std::string& tool) {
  const std::string yes = "true";
  Element root("fmiModelDescription");
  root.set("fmiVersion", "3.0").set("modelName", name).set("instantiationToken", token);
  root.set("description", "A free-floating platform under its disturbances and its light");
  root.set("generationTool", tool).set("variableNamingConvention", "flat");
  Element kind("CoSimulation");
  kind.set("modelIdentifier", "photorque").set("canGetAndSetFMUState", yes);
  kind.set("canSerializeFMUState", yes).set("canHandleVariableCommunicationStepSize", yes);
  kind.set("fixedInternalStepSize", 1.0 / unit.rate_Hz);
  Element experiment("DefaultExperiment");
  experiment.set("startTime", unit.start_s).set("stopTime", unit.stop_s);
  experiment.set("stepSize", 1.0 / unit.rate_Hz);
  std::string text = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n" + root.text + ">\n";
  text += kind.line("  ") + unit_definitions + log_categories + experiment.line("  ");
  text += "  <ModelVariables>\n";
  for (const UnitVariable& variable : unit.variables) text += variable_line(variable, unit);
  text += "  </ModelVariables>\n  <ModelStructure>\n" + structure_lines(unit);
  return text + "  </ModelStructure>\n</fmiModelDescription>\n";
}

}  // namespace photorque
