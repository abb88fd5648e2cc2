// Loads, compares, reports.
// SPDX-License-Identifier: Apache-2.0
#include "tools/compare/compare.h"

#include <cstdio>
#include <filesystem>
#include <optional>

#include <nlohmann/json.hpp>

#include "hil/report/page.h"
#include "shared/base/xml_text.hpp"
#include "shared/plot/svg.h"
#include "tools/base/output.h"
#include "tools/base/output_file.h"
#include "tools/base/provenance.h"
#include "tools/compare/comparison.h"

namespace kaz::tools {
namespace {

OutputKind compare_output() {
  return {"compare", {"report.html", "result.json", "joints.svg", "link.svg"}};
}

// The text of `kaz compare --all` as a page, with the plots.
std::string page(const std::string& text, const std::vector<plot::PlotPage>& plots) {
  std::string html =
      hil::page_head("Kaz: two runs compared", "svg { max-width: 100%; height: auto }");
  html += "<h1>Two runs compared</h1>\n<p class=\"facts\">" + hil::provenance_html(provenance()) +
          "</p>\n<pre>" + xml_text(text) + "</pre>\n";
  for (const plot::PlotPage& one : plots)
    html += "<figure>\n" + plot::plot_svg(one) + "</figure>\n";
  return html + hil::kPageEnd;
}

}  // namespace

Result<bool> compare_recordings(const CompareOptions& options) {
  std::optional<OutputFolder> folder;
  if (!options.out.empty()) folder = KAZ_TRY(OutputFolder::begin(options.out, compare_output()));
  std::error_code none;
  if (std::filesystem::equivalent(options.a, options.b, none))
    std::fprintf(stderr, "kaz compare: A and B are the same recording\n");
  const RunTrace a = KAZ_TRY(RunTrace::load(options.a));
  const RunTrace b = KAZ_TRY(RunTrace::load(options.b));
  const Comparison comparison = compare(a, b);
  auto json = comparison_json(comparison, a, b);
  json["provenance"] = provenance_json();
  if (options.json) print_json(json);
  if (folder) {
    const auto plots = comparison_plots(a, b);
    const auto write = [&]() -> Result<void> {
      if (plots.size() > 1) KAZ_TRY(folder->write("joints.svg", plot::plot_svg(plots.front())));
      KAZ_TRY(folder->write("link.svg", plot::plot_svg(plots.back())));
      KAZ_TRY(folder->write("report.html", page(comparison_text(comparison, a, b, true), plots)));
      return folder->write_json("result.json", json);
    };
    KAZ_TRY(write());
  }
  if (!options.json) {
    std::printf("%s", comparison_text(comparison, a, b, options.all, list_width()).c_str());
    if (folder) std::printf("report.html, plots and result.json are in %s\n", options.out.c_str());
  }
  return comparison.differing() == 0;
}

}  // namespace kaz::tools
