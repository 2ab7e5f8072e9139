// The look of the report: dark text on white, one column, prints on A4.
#pragma once

namespace photorque {

inline constexpr const char* report_style = R"css(
:root { color-scheme: light; }
* { box-sizing: border-box; }
body { margin: 0; background: #eef1f4; color: #1b1f24;
  font: 16px/1.5 system-ui, "Segoe UI", "Helvetica Neue", "DejaVu Sans", sans-serif; }
main { max-width: 1000px; margin: 0 auto; background: #fff; padding: 36px 40px 28px; }
header { border-bottom: 1px solid #d5d9de; padding-bottom: 22px; }
.title { margin: 0 0 14px; color: #4a525b; font-size: 14px; }
.verdict { display: inline-block; padding: 4px 14px; border-radius: 16px; font-weight: 600;
  font-size: 14px; color: #fff; }
.verdict.good { background: #00694f; }
.verdict.found { background: #005a92; }
.verdict.open { background: #a84300; }
h1 { font-size: 26px; line-height: 1.3; margin: 14px 0 20px; font-weight: 650;
  text-wrap: pretty; }
h2 { font-size: 20px; margin: 34px 0 8px; font-weight: 650; }
h3 { font-size: 16px; margin: 18px 0 6px; font-weight: 650; }
h3 small { font-weight: 400; color: #4a525b; margin-left: 8px; font-size: 14px; }
p, ul { margin: 6px 0 10px; max-width: 75ch; }
.figures { display: flex; flex-wrap: wrap; gap: 14px; }
.figure { flex: 1 1 200px; background: #f5f7f9; border-radius: 8px; padding: 10px 16px; }
.figure b { display: block; font-size: 21px; font-variant-numeric: tabular-nums; }
.figure span { font-size: 13px; color: #4a525b; line-height: 1.35; display: block; }
.warning { background: #fff3e6; border-left: 4px solid #a84300; padding: 10px 14px;
  margin-top: 16px; }
.card { border: 1px solid #d5d9de; border-radius: 8px; padding: 2px 18px 12px; margin: 12px 0; }
.card h3::first-letter, figcaption::first-letter { text-transform: uppercase; }
.group { background: #f5f7f9; padding: 8px 12px; border-radius: 6px; }
table { border-collapse: collapse; margin: 8px 0; font-size: 15px; }
th { text-align: left; font-weight: 600; font-size: 13px; color: #4a525b; }
th, td { padding: 4px 26px 4px 0; border-bottom: 1px solid #e7eaed; vertical-align: baseline; }
.numbers td { font-variant-numeric: tabular-nums; }
.numbers td + td { white-space: nowrap; }
sup { line-height: 0; }
figure { margin: 18px 0 22px; }
figcaption { font-weight: 600; font-size: 15px; margin-bottom: 2px; }
.maps { display: grid; grid-template-columns: 1fr 1fr; gap: 4px 20px; }
.maps figure { margin: 6px 0; }
svg.array { max-width: 560px; }
svg.array .cell { fill: #e6edf5; stroke: #1b1f24; stroke-width: 0.8; }
svg.array .suspect { fill: #d55e00; fill-opacity: 0.75; stroke: #1b1f24; stroke-width: 0.8; }
svg.array .shadow { fill: #1b1f24; fill-opacity: 0.35; stroke: #1b1f24; stroke-dasharray: 4 3; }
svg.chart { display: block; width: 100%; height: auto; }
.legend { max-width: none; font-size: 14px; }
.key { display: inline-block; width: 26px; height: 0; vertical-align: middle;
  border-top: 3px solid; }
.key.dots { border-top: 4px dotted #5c5c5c; }
.key.before { border-top: 3px dashed #d55e00; }
.key.after { border-color: #0072b2; }
.key.level { border-top: 2px dotted #1b1f24; }
.key.shade { height: 14px; border: 1px solid #c3cfdd; background: #e6edf5; }
footer { margin-top: 36px; padding-top: 12px; border-top: 1px solid #d5d9de; font-size: 12px;
  color: #4a525b; overflow-wrap: anywhere; }
@media print {
  body { background: #fff; font-size: 11pt; }
  main { max-width: none; padding: 0; }
  figure, .card, svg, tr, .figures { break-inside: avoid; }
  h2, h3, figcaption { break-after: avoid; }
  .verdict, .key, .figure, .warning { print-color-adjust: exact; -webkit-print-color-adjust: exact; }
}
@media (max-width: 640px) { main { padding: 20px 16px; } h1 { font-size: 21px; } }
)css";

}  // namespace photorque
