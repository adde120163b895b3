#include "report/report_page.h"

#include <fmt/format.h>

#include "host/text_sink.h"
#include "report/svg_plot.h"
#include "report/svg_text.h"

namespace hydroscope {
namespace {

constexpr const char* kColours =
    R"css(--page:#f4f6f8;--paper:#ffffff;--ink:#1d2329;--soft:#56616c;--rule:#dbe1e6;
--ok:#00704f;--oil:#00629b;--hint:#8a6100;--bad:#b84700;--alarm:#a3222c;--none:#56616c;color-scheme:light;)css";
constexpr const char* kDarkColours =
    R"css(--page:#11151a;--paper:#191e24;--ink:#e4e8ec;--soft:#a3adb8;--rule:#2f3740;
--ok:#35c99c;--oil:#62baee;--hint:#e9b13a;--bad:#f5905a;--alarm:#ff8087;--none:#a3adb8;color-scheme:dark;)css";

constexpr const char* kStyle = R"css(
*{box-sizing:border-box}
html{background:var(--page);-webkit-text-size-adjust:100%}
body{margin:0 auto;max-width:1120px;padding:28px 20px 48px;color:var(--ink);background:var(--page);
font:15.5px/1.5 system-ui,"Segoe UI",Roboto,"DejaVu Sans",sans-serif;overflow-wrap:anywhere}
header{display:flex;gap:16px;align-items:flex-start;justify-content:space-between;margin-bottom:18px}
h1{font-size:26px;line-height:1.2;margin:0 0 4px}
h2{font-size:19px;margin:38px 0 4px;padding-top:14px;border-top:2px solid var(--rule)}
h3{font-size:16px;margin:0}
p{margin:6px 0}
.soft,figcaption,.note{color:var(--soft);font-size:14px}
button{font:inherit;font-size:14px;color:var(--ink);background:var(--paper);border:1px solid var(--rule);border-radius:6px;
padding:5px 12px;cursor:pointer;white-space:nowrap}
button:focus-visible{outline:2px solid var(--oil)}
.verdict,.card,figure,.tile,.sheet{background:var(--paper);border:1px solid var(--rule);border-radius:8px}
.verdict{border-left:7px solid var(--tone);padding:16px 22px 14px;margin-bottom:16px}
.verdict h2{border:0;margin:0 0 6px;padding:0;font-size:22px;line-height:1.3}
.verdict ul{margin:6px 0 8px;padding-left:20px}
.verdict li{margin:4px 0}
.cards,.trends{display:grid;grid-template-columns:repeat(2,minmax(0,1fr));gap:14px}
.trends{gap:2px 14px}
.card{border-top:4px solid var(--tone);padding:13px 18px 12px}
.card h3{display:flex;flex-wrap:wrap;gap:4px 10px;align-items:baseline}
.card h3 .name{font-weight:500;color:var(--soft)}
.pill{margin-left:auto;font-size:13px;font-weight:600;color:var(--tone);border:1.5px solid var(--tone);border-radius:99px;
padding:1px 10px;white-space:nowrap}
.value{font-size:21px;font-weight:600;margin:4px 0 2px;font-variant-numeric:tabular-nums}
.value span{display:inline-block;font-size:13.5px;font-weight:400;color:var(--soft)}
.reading{margin:4px 0 8px}
dl{display:grid;grid-template-columns:8.6em minmax(0,1fr);gap:3px 10px;margin:8px 0 0;font-size:14px;line-height:1.42}
dt{color:var(--soft)}dd{margin:0}
.steady{--tone:var(--ok)}.oil{--tone:var(--oil)}.hint{--tone:var(--hint)}.changed,.warned{--tone:var(--bad)}
.alarmed{--tone:var(--alarm)}.unknown{--tone:var(--none)}
.tiles{display:grid;grid-template-columns:repeat(5,minmax(0,1fr));gap:12px;margin:22px 0 0}
.tile{padding:10px 14px}
.tile b{display:block;font-size:20px;line-height:1.25;font-variant-numeric:tabular-nums}
.tile span{color:var(--soft);font-size:13.5px}
figure{margin:12px 0 0;padding:12px 14px 8px}
figcaption{margin:2px 4px 4px}
.halves{display:grid;grid-template-columns:repeat(2,minmax(0,1fr));gap:14px}
.pair{display:grid;grid-template-columns:calc(30px + (100% - 74px)*.61538) minmax(0,1fr);gap:14px}
table{border-collapse:collapse;width:100%;font-size:14.5px}
th,td{text-align:left;padding:6px 12px 6px 0;border-bottom:1px solid var(--rule);vertical-align:top}
th{color:var(--soft);font-weight:600}
.number{text-align:right;font-variant-numeric:tabular-nums;white-space:nowrap}
.sheet{padding:8px 18px 12px;margin-top:12px;overflow-x:auto}
.ids td:first-child{white-space:nowrap}
.terms{grid-template-columns:15em minmax(0,1fr);font-size:14.5px;gap:6px 16px}
.terms dt{color:var(--ink);font-weight:600}
sub{line-height:0;font-size:72%}
@media screen and (max-width:820px){.cards,.trends,.pair,.halves{grid-template-columns:minmax(0,1fr)}.tiles{grid-template-columns:repeat(2,minmax(0,1fr))}
.terms,dl{grid-template-columns:minmax(0,1fr)}dd{margin-bottom:5px}body{padding:16px 12px 32px}
figure{overflow-x:auto}figure svg{min-width:640px}.pair figure:last-child svg,.halves svg{min-width:330px}}
@page{size:A4;margin:14mm 13mm}
@media print{html,body{background:#fff}body{max-width:none;padding:0;font-size:9.6pt;line-height:1.4}
button{display:none}h1{font-size:17pt}h2{font-size:13pt;margin-top:18pt;padding-top:6pt;break-after:avoid}.verdict h2{font-size:14pt}
.value{font-size:13pt}.reading{margin:2pt 0 4pt}dl,.soft,figcaption,.note,table,.tile span,.value span,.terms{font-size:8.6pt}.pill{font-size:8pt}
.tile b{font-size:12pt}.card,figure,.tile,.verdict,.sheet,tr,.terms div{break-inside:avoid}.pair,.halves{break-inside:avoid;gap:8px}
.cards{gap:8px}.card{padding:8px 11px}figure{padding:6px 8px 4px}h2+p,figcaption{break-after:avoid}
.tiles{grid-template-columns:repeat(5,minmax(0,1fr))}.cards{grid-template-columns:repeat(2,minmax(0,1fr))}
.pair{grid-template-columns:calc(18px + (100% - 44px)*.61538) minmax(0,1fr)}dl{grid-template-columns:8.2em minmax(0,1fr)}.terms{grid-template-columns:13em minmax(0,1fr)}
.verdict,.card,.pill{-webkit-print-color-adjust:exact;print-color-adjust:exact}}
)css";

/// The button stands only where scripts run; the choice stays with the page as long as it is open.
constexpr const char* kScript = R"js(
(function(){var r=document.documentElement,b=document.createElement('button');b.type='button';
function dark(){var t=r.getAttribute('data-theme');return t?t==='dark':matchMedia('(prefers-color-scheme: dark)').matches}
function name(){b.textContent=dark()?'Light theme':'Dark theme'}
b.onclick=function(){r.setAttribute('data-theme',dark()?'light':'dark');name()};name();
document.querySelector('header').appendChild(b)})();
)js";

std::string Themes() {
  const std::string light = kColours, dark = kDarkColours;
  return ":root{" + light + "}\n@media (prefers-color-scheme:dark){:root:not([data-theme=light]){" + dark +
         "}}\n:root[data-theme=dark]{" + dark +
         "}\n@media print{:root,:root[data-theme=dark],:root:not([data-theme=light]){" + light + "}}\n";
}

const char* ToneOf(Verdict verdict) {
  switch (verdict) {
    case Verdict::kAdequate:
      return "steady";
    case Verdict::kNamed:
      return "changed";
    case Verdict::kAmbiguous:
      return "hint";
    case Verdict::kUnknown:
      return "unknown";
  }
  return "unknown";
}

}  // namespace

std::string HtmlPage(const std::string& title, const std::string& body) {
  return "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n"
         "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n<title>" +
         EscapeText(title) + "</title>\n<style>" + Themes() + PlotStyleSheet() + kStyle +
         "</style>\n</head>\n<body>\n" + body + "<script>" + kScript + "</script>\n</body>\n</html>\n";
}

std::string Figure(const std::string& svg, const std::string& caption) {
  if (svg.empty()) return "";
  return "<figure>" + svg + (caption.empty() ? "" : "<figcaption>" + caption + "</figcaption>") +
         "</figure>\n";
}

std::string VerdictSection(Verdict verdict, const std::string& headline,
                           const std::vector<std::string>& sentences) {
  std::string out = fmt::format("<section class=\"verdict {}\"><h2>{}</h2><ul>", ToneOf(verdict), headline);
  for (const std::string& sentence : sentences) out += "<li>" + sentence + "</li>";
  return out + "</ul></section>\n";
}

Status WritePage(const std::string& path, const std::string& title, const std::string& body) {
  return WriteTextFile(path, HtmlPage(title, body));
}

}  // namespace hydroscope
