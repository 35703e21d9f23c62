#pragma once

namespace palpate::pipeline {

/// Style of the report page.
inline constexpr const char* page_style = R"css(
:root{color-scheme:light;--ink:#1c2530;--soft:#5b6773;--line:#d8dee5;--blue:#2a6f97;--amber:#c8741a}
body{font:16px/1.5 system-ui,sans-serif;color:var(--ink);max-width:68rem;margin:2rem auto;padding:0 1rem}
h1{font-size:1.7rem;margin:0 0 .2rem}h2{font-size:1.2rem;margin:2.2rem 0 .6rem;border-bottom:1px solid var(--line);padding-bottom:.2rem}
p.lead{font-size:1.1rem;margin:.4rem 0 1rem}.soft{color:var(--soft)}
.tiles{display:grid;grid-template-columns:repeat(auto-fit,minmax(8.4rem,1fr));gap:.8rem}
.tile{border:1px solid var(--line);border-radius:.5rem;padding:.7rem .9rem}.tile b{display:block;font-size:1.45rem}
.pair{display:grid;grid-template-columns:repeat(auto-fit,minmax(22rem,1fr));gap:1.2rem}
svg{width:100%;height:auto;display:block}svg text{font:12px system-ui,sans-serif;fill:var(--ink)}svg .small{font-size:12px;fill:var(--soft)}
.sphere{fill:#2a6f97;fill-opacity:.12;stroke:#2a6f97;stroke-opacity:.5}.held{fill:#c8741a;fill-opacity:.35;stroke:#c8741a}.center{fill:#1c2530}
.bar{fill:var(--blue)}.bar.held-out{fill:var(--amber)}
table{border-collapse:collapse;width:100%;font-size:.92rem}th,td{text-align:right;padding:.25rem .6rem;border-bottom:1px solid var(--line)}
th:first-child,td:first-child{text-align:left}pre{background:#f5f7f9;padding:.8rem;overflow:auto;font-size:.85rem}
.scroll{max-height:24rem;overflow:auto}
@media print{body{max-width:none;margin:0}.scroll{max-height:none}}
)css";

}  // namespace palpate::pipeline
