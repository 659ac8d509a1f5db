#include "hil/report/html_page.h"

#include "hil/base/digest.h"
#include "hil/report/figures/style.h"
#include "hil/report/figures/text.h"

namespace forcegate {
namespace {

using figures::escape;

constexpr std::string_view kPageCss = R"(
*{box-sizing:border-box}
body{margin:0;background:var(--page);color:var(--ink);font:15px/1.5 system-ui,'Segoe UI',Helvetica,Arial,sans-serif;overflow-wrap:anywhere}
main,header>div{max-width:1200px;margin:0 auto;padding:0 20px}
header{border-top:8px solid var(--v,var(--quiet));border-bottom:1px solid var(--grid);padding:18px 0 14px;margin-bottom:8px}
h1{font-size:30px;line-height:1.2;margin:0 0 6px;color:var(--vt,var(--ink));letter-spacing:.01em}
.why{font-size:19px;line-height:1.35;margin:0 0 10px;max-width:70ch}
h2{font-size:19px;margin:32px 0 8px}h3{font-size:15px;margin:18px 0 6px}
p{margin:0 0 10px;max-width:80ch}.q,dt,caption,th,figcaption{color:var(--quiet)}
.facts{display:flex;flex-wrap:wrap;gap:4px 22px;margin:0;padding:0;list-style:none;font-size:14px}
.facts b{font-weight:600}
a{color:var(--gdt)}a:focus-visible,summary:focus-visible,[tabindex]:focus-visible,button:focus-visible,input:focus-visible,select:focus-visible{outline:3px solid var(--gd);outline-offset:2px}
.ok{--v:var(--ok);--vt:var(--okt)}.no{--v:var(--no);--vt:var(--not)}.wa{--v:var(--wa);--vt:var(--wat)}.mu{--v:var(--mu);--vt:var(--mut)}
.w{color:var(--vt);font-weight:600;white-space:nowrap}
.scroll{overflow-x:auto;margin:0 0 12px}
table{border-collapse:collapse;font-size:14px;width:100%}
caption{text-align:left;padding:0 0 4px}
th{font-weight:600;text-align:left;font-size:13px}
th,td{padding:5px 14px 5px 0;border-bottom:1px solid var(--grid);vertical-align:top;overflow-wrap:normal}
td.n,th.n{text-align:right;font-variant-numeric:tabular-nums;white-space:nowrap}
td.c{min-width:15em}td.bar{width:206px;min-width:206px}td small{color:var(--quiet);display:block;font-size:13px}
details.case{border:1px solid var(--grid);border-left:5px solid var(--v);border-radius:4px;margin:0 0 8px}
details.case>summary{cursor:pointer;padding:8px 12px;display:flex;flex-wrap:wrap;gap:2px 16px;align-items:baseline}
details.case>summary .id{font-weight:600}
details.case>summary::before{content:"\25B8";color:var(--quiet)}details.case[open]>summary::before{content:"\25BE"}
details.case>summary::-webkit-details-marker{display:none}
.in{padding:2px 14px 12px}
.figs{display:grid;grid-template-columns:repeat(auto-fit,minmax(min(100%,500px),1fr));gap:14px 28px;margin:8px 0}
figure{margin:0 0 12px;min-width:0}figure .box{overflow-x:auto}figure .box>svg{max-width:100%;height:auto;display:block}.figs.s{grid-template-columns:repeat(auto-fit,minmax(min(100%,350px),1fr))}
figcaption{font-size:13px;margin-top:2px;max-width:70ch}
dl{display:grid;grid-template-columns:max-content 1fr;gap:2px 18px;font-size:14px;margin:0 0 12px}dd{margin:0}
code,pre{font-family:ui-monospace,SFMono-Regular,Menlo,Consolas,monospace;font-size:13px}
pre{border:1px solid var(--grid);border-radius:4px;padding:10px 12px;margin:0 0 12px;white-space:pre-wrap;user-select:all}
.tools{display:flex;flex-wrap:wrap;gap:8px 14px;align-items:center;margin:0 0 12px;font-size:14px}.tools[hidden]{display:none}
.tools input,.tools select,.tools button{font:inherit;color:inherit;background:var(--page);border:1px solid var(--quiet);border-radius:4px;padding:4px 8px}
nav{font-size:14px;margin:8px 0 0}nav a{margin-right:16px}
footer{border-top:1px solid var(--grid);margin-top:36px;padding:12px 0 28px;font-size:13px;color:var(--quiet)}
@media (max-width:680px){.k thead{position:absolute;width:1px;height:1px;overflow:hidden;clip-path:inset(50%)}
.k,.k tbody,.k caption{display:block}.k tr{display:flex;flex-wrap:wrap;gap:0 14px;border-bottom:1px solid var(--grid);padding:6px 0}.k td{border:0;padding:1px 0}
.k td.c{flex-basis:100%;min-width:0}.k td.val{font-weight:600}.k td.lim::before{content:"limit ";color:var(--quiet)}.k td.bar{min-width:0}}
@media (max-width:560px){figure .box>svg{max-width:none}dl{grid-template-columns:1fr}dd{margin:0 0 6px}h1{font-size:26px}.why{font-size:17px}}
@media (prefers-reduced-motion:no-preference){html{scroll-behavior:smooth}}
@media print{body{font-size:11pt}.tools,nav{display:none}details.case,figure,tr{break-inside:avoid}a{color:inherit}main,header>div{max-width:none}}
)";

constexpr std::string_view kFilterScript = R"(
(function(){var t=document.getElementById('tools');if(!t)return;t.hidden=false;
var q=document.getElementById('q'),v=document.getElementById('v'),c=document.getElementById('count');
var all=Array.prototype.slice.call(document.querySelectorAll('details.case'));
function run(){var s=q.value.trim().toLowerCase(),n=0;all.forEach(function(d){
var on=(!v.value||d.dataset.v===v.value)&&(!s||d.dataset.t.indexOf(s)>=0);d.hidden=!on;if(on)n++;});
c.textContent=n+' of '+all.length+' shown';}
function open(b){all.forEach(function(d){if(!d.hidden)d.open=b;});}
q.addEventListener('input',run);v.addEventListener('change',run);
document.getElementById('o').addEventListener('click',function(){open(true);});
document.getElementById('x').addEventListener('click',function(){open(false);});run();})();
)";

}  // namespace

std::string csp_hash(std::string_view text) {
  static const char kAlphabet[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  const std::string hex = sha256_hex(text);
  const auto nibble = [&](std::size_t i) -> unsigned {
    return i >= hex.size() ? 0u : static_cast<unsigned>(hex[i] <= '9' ? hex[i] - '0' : hex[i] - 'a' + 10);
  };
  std::string out = "sha256-";
  for (std::size_t i = 0; i < hex.size(); i += 6) {
    unsigned bits = 0;
    for (std::size_t k = 0; k < 6; ++k) bits = bits << 4 | nibble(i + k);
    const std::size_t bytes = std::min<std::size_t>(3, (hex.size() - i) / 2);
    for (std::size_t k = 0; k < 4; ++k) out += k <= bytes ? kAlphabet[bits >> (18 - 6 * k) & 63u] : '=';
  }
  return out;
}

std::string html_document(const HtmlPage& page) {
  const std::string style = figures::theme_css() + figures::figure_css(true) + std::string(kPageCss);
  std::string policy = "default-src 'none'; style-src '" + csp_hash(style) + "'";
  if (page.with_filter) policy += "; script-src '" + csp_hash(kFilterScript) + "'";
  policy += "; base-uri 'none'; form-action 'none'";
  std::string out = "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n";
  out += "<meta http-equiv=\"Content-Security-Policy\" content=\"" + policy + "\">\n";
  out += "<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\n";
  out += "<meta name=\"color-scheme\" content=\"light dark\">\n<title>" + escape(page.title) + "</title>\n";
  out += "<style>" + style + "</style></head>\n<body>\n" + page.body;
  if (page.with_filter) out += "<script>" + std::string(kFilterScript) + "</script>\n";
  return out + "</body></html>\n";
}

std::string html_filter_row(const std::vector<std::string>& verdicts) {
  std::string out =
      "<div class=\"tools\" id=\"tools\" hidden><label>Filter <input id=\"q\" type=\"search\"></label>"
      "<label>Verdict <select id=\"v\"><option value=\"\">all</option>";
  for (const std::string& v : verdicts) out += "<option>" + escape(v) + "</option>";
  return out +
         "</select></label><button type=\"button\" id=\"o\">Open all</button>"
         "<button type=\"button\" id=\"x\">Close all</button><span id=\"count\" role=\"status\" "
         "class=\"q\"></span></div>\n";
}

std::string html_figure(const std::string& svg, std::string_view label, std::string_view caption_html) {
  return "<figure><div class=\"box\" tabindex=\"0\" role=\"group\" aria-label=\"" + escape(label) + "\">" +
         svg + "</div><figcaption>" + std::string(caption_html) + "</figcaption></figure>\n";
}

}  // namespace forcegate
