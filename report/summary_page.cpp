#include "report/summary_page.hpp"

#include <nlohmann/json.hpp>

#include "report/page.hpp"
#include "underbrush/io/json_text.inl"

namespace underbrush::report {

std::filesystem::path write_summary_page(const std::filesystem::path& folder,
                                         const SummaryPage& page) {
  const auto provenance = io::json_of_text(page.provenance);
  return write_page(folder,
                    filled_summary({{"title", escaped(page.title)},
                                    {"lead", escaped(page.lead)},
                                    {"verdict", escaped(page.verdict)},
                                    {"checks", page.asked},
                                    {"body", page.body},
                                    {"provenance", escaped(io::text_of_json(provenance, 2))}}));
}

}  // namespace underbrush::report
