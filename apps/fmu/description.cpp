#include <array>
#include <cstdio>

#include "underbrush/core/rng.hpp"
#include "variables.hpp"

namespace underbrush::fmu {
namespace {

constexpr const char* kAbout = "A lidar, from reflections or the ground truth to a list of objects";
// The end of the tag that holds an annotation of OSMP, and the annotation of the model.
constexpr const char* kSpace = " xmlns:osmp=\"http://xsd.pmsf.net/OSISensorModelPackaging\">";
constexpr const char* kOsmp = "<osmp:osmp version=\"1.6.0\" osi-version=\"3.8.0\"/>";

std::string_view causality(Role role) {
  constexpr std::array<std::string_view, 4> kWords{"input", "output", "parameter",
                                                   "calculatedParameter"};
  return kWords[size_t(role)];
}

std::string_view variability(Role role) {
  return role == Role::kInput || role == Role::kOutput ? "discrete" : "fixed";
}

std::string mime_type(const Variable& v) {
  return "application/x-open-simulation-interface; type=" + std::string(v.start) +
         "; version=3.8.0";
}

// The limits of a number as attributes.
std::string limits(const Variable& v) {
  if (!v.has_limits()) return "";
  const auto text = [&](double x) {
    if (v.type == Type::kInteger) return std::to_string(int64_t(x));
    std::array<char, 32> buffer{};
    std::snprintf(buffer.data(), buffer.size(), "%g", x);
    return std::string(buffer.data());
  };
  const std::string most = std::isinf(v.most) ? "" : " max=\"" + text(v.most) + "\"";
  return " min=\"" + text(v.least) + "\"" + most;
}

// The attributes that both versions of FMI and all types share.
std::string attributes(std::string_view name, uint32_t reference, const Variable& v) {
  std::string text = "name=\"" + std::string(name) + "\" valueReference=\"" +
                     std::to_string(reference) + "\" causality=\"" +
                     std::string(causality(v.role)) + "\" variability=\"" +
                     std::string(variability(v.role)) + "\"";
  if (v.role == Role::kCalculatedParameter) text += " initial=\"calculated\"";
  if (v.role == Role::kOutput || v.role == Role::kParameter) text += " initial=\"exact\"";
  return text + " description=\"" + v.meaning + "\"";
}

std::string header(const char* version, const char* identity, const std::string& guid) {
  return std::string(
             "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
             "<fmiModelDescription fmiVersion=\"") +
         version + "\" modelName=\"underbrush\" " + identity + "=\"" + guid +
         "\"\n    description=\"" + kAbout +
         "\" author=\"The Underbrush developers\" version=\"0.1.0\" license=\"Apache-2.0\"\n"
         "    generationTool=\"Underbrush\" variableNamingConvention=\"structured\">\n"
         "  <CoSimulation modelIdentifier=\"underbrush\" "
         "canHandleVariableCommunicationStepSize=\"true\" ";
}

constexpr const char* kLogAndExperiment =
    "  <LogCategories>\n    <Category name=\"input\" description=\"Inputs that cannot be "
    "used\"/>\n"
    "    <Category name=\"call\" description=\"Calls that are not allowed\"/>\n"
    "  </LogCategories>\n"
    "  <DefaultExperiment startTime=\"0.0\" stepSize=\"0.05\"/>\n";

// FMI 2.0 has no binary variables: OSMP makes three integers of each.
std::string binary2(const Variable& v) {
  constexpr const char* kParts[] = {"base.lo", "base.hi", "size"};
  std::string text;
  for (uint32_t k = 0; k < 3; ++k) {
    text += "    <ScalarVariable " +
            attributes(std::string(v.name) + "." + kParts[k], v.reference + k, v) + ">\n";
    text += v.role == Role::kCalculatedParameter ? "      <Integer/>\n"
                                                 : "      <Integer start=\"0\"/>\n";
    text += std::string("      <Annotations>\n        <Tool name=\"net.pmsf.osmp\"") + kSpace +
            "<osmp:osmp-binary-variable name=\"" + std::string(v.name) + "\" role=\"" + kParts[k] +
            "\" mime-type=\"" + mime_type(v) +
            "\"/></Tool>\n      </Annotations>\n    </ScalarVariable>\n";
  }
  return text;
}

std::string plain2(const Variable& v) {
  constexpr const char* kTypes[] = {"", "Integer", "Real", "Boolean", "String"};
  return "    <ScalarVariable " + attributes(v.name, v.reference, v) + ">\n      <" +
         kTypes[size_t(v.type)] + limits(v) + " start=\"" + std::string(v.start) +
         "\"/>\n    </ScalarVariable>\n";
}

// FMI 2.0 names unknowns by their place in the list of variables.
std::string unknowns2(const char* tag, Role role) {
  std::string text;
  uint32_t index = 1;
  for (const Variable& v : variables()) {
    const uint32_t parts = v.type == Type::kBinary ? 3 : 1;
    for (uint32_t k = 0; k < parts; ++k, ++index) {
      if (v.role == role) text += "      <Unknown index=\"" + std::to_string(index) + "\"/>\n";
    }
  }
  return "    <" + std::string(tag) + ">\n" + text + "    </" + tag + ">\n";
}

std::string text2(const std::string& guid) {
  std::string text = header("2.0", "guid", guid) +
                     "canGetAndSetFMUstate=\"true\" "
                     "canNotUseMemoryManagementFunctions=\"true\"/>\n" +
                     kLogAndExperiment + "  <VendorAnnotations>\n    <Tool name=\"net.pmsf.osmp\"" +
                     kSpace + kOsmp + "</Tool>\n  </VendorAnnotations>\n  <ModelVariables>\n";
  for (const Variable& v : variables()) text += v.type == Type::kBinary ? binary2(v) : plain2(v);
  return text + "  </ModelVariables>\n  <ModelStructure>\n" + unknowns2("Outputs", Role::kOutput) +
         unknowns2("InitialUnknowns", Role::kCalculatedParameter) +
         "  </ModelStructure>\n</fmiModelDescription>\n";
}

std::string variable3(const Variable& v) {
  constexpr const char* kTypes[] = {"Binary", "Int32", "Float64", "Boolean", "String"};
  const std::string type = kTypes[size_t(v.type)], start(v.start);
  const std::string begin = "    <" + type + " " + attributes(v.name, v.reference, v);
  const std::string end = "</" + type + ">\n";
  if (v.type == Type::kString) return begin + "><Start value=\"" + start + "\"/>" + end;
  if (v.type != Type::kBinary) return begin + limits(v) + " start=\"" + start + "\"/>\n";
  const std::string typed = begin + " mimeType=\"" + mime_type(v) + "\"";
  return v.role == Role::kCalculatedParameter ? typed + "/>\n"
                                              : typed + "><Start value=\"\"/>" + end;
}

std::string unknowns3(const char* tag, Role role) {
  std::string text;
  for (const Variable& v : variables()) {
    if (v.role != role) continue;
    text +=
        "    <" + std::string(tag) + " valueReference=\"" + std::to_string(v.reference) + "\"/>\n";
  }
  return text;
}

std::string text3(const std::string& guid) {
  std::string text = header("3.0", "instantiationToken", guid) +
                     "canGetAndSetFMUState=\"true\"/>\n" + kLogAndExperiment +
                     "  <ModelVariables>\n    <Float64 name=\"time\" valueReference=\"" +
                     std::to_string(kTime) +
                     "\" causality=\"independent\" variability=\"continuous\" "
                     "description=\"The simulation's time.\"/>\n";
  for (const Variable& v : variables()) text += variable3(v);
  return text + "  </ModelVariables>\n  <ModelStructure>\n" + unknowns3("Output", Role::kOutput) +
         unknowns3("InitialUnknown", Role::kCalculatedParameter) +
         "  </ModelStructure>\n  <Annotations>\n    <Annotation type=\"net.pmsf.osmp\"" + kSpace +
         kOsmp + "</Annotation>\n  </Annotations>\n</fmiModelDescription>\n";
}

std::string text_with(Fmi version, const std::string& guid) {
  return version == Fmi::k2 ? text2(guid) : text3(guid);
}

}  // namespace

std::string description(Fmi version) { return text_with(version, guid(version)); }

std::string guid(Fmi version) {
  uint64_t high = 1, low = 2;
  for (const char c : text_with(version, "")) {
    high = mix64(high ^ uint8_t(c));
    low = mix64(low + uint8_t(c) + high);
  }
  char text[40];
  std::snprintf(text, sizeof text, "{%08x-%04x-%04x-%04x-%012llx}", uint32_t(high >> 32),
                uint32_t(high >> 16) & 0xFFFF, uint32_t(high) & 0xFFFF, uint32_t(low >> 48),
                static_cast<unsigned long long>(low & 0xFFFFFFFFFFFFull));
  return text;
}

}  // namespace underbrush::fmu
