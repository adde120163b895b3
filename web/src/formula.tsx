// Laws as the effect library writes them, drawn as mathematics.

import { useEffect, useRef } from "preact/hooks";

const functions = new Set(["sign", "max", "min", "exp", "sin", "cos", "play", "abs"]);
const greek = new Set(["beta", "tau", "pi", "phi", "mu"]);

function symbol(name: string): string {
  const [head, ...rest] = name.split("_");
  const numbered = head.match(/^([A-Za-z])(\d+)$/);
  const body = numbered ? `${numbered[1]}_{${numbered[2]}}` : head === "dp" ? "\\Delta p"
    : greek.has(head) ? `\\${head}` : head.length > 1 ? `\\mathrm{${head}}` : head;
  return rest.length > 0 ? `${body}_{\\mathrm{${rest.join(",")}}}` : body;
}

/** TeX of a law such as "Q = G max(p_A - p_crack, 0)"; words between stay words. */
export function texOf(law: string): string {
  const tokens: string[] = law.match(/d[A-Za-z]\w*\/d[a-z]\b|ddt\(\w+\)|\w+|\+-|[^\s\w]|\s+/g) ?? [];
  let tex = "";
  for (let k = 0; k < tokens.length; ++k) {
    const token = tokens[k];
    const rate = token.match(/^d([A-Za-z]\w*)\/dt$/) ?? token.match(/^ddt\((\w+)\)$/);
    const slope = token.match(/^d(\w+)\/d([a-z])$/);
    const plainWord = token === "of" || (/^[a-z]{3,}$/i.test(token) && !greek.has(token));
    if (rate) tex += `\\dot{${symbol(rate[1])}}`;
    else if (slope) tex += `\\frac{\\mathrm{d}${symbol(slope[1])}}{\\mathrm{d}${slope[2]}}`;
    else if (token === "degC") tex += "\\,^{\\circ}\\mathrm{C}";
    else if (token === "sqrt") {
      // sqrt|...| or sqrt(...): up to the bar or bracket that closes it
      const close = tokens[k + 1] === "|" ? "|" : ")";
      let depth = 0, end = k + 2;
      for (; end < tokens.length; ++end) {
        if (tokens[end] === "(" && close === ")") ++depth;
        if (tokens[end] === close && depth-- === 0) break;
      }
      const inner = texOf(tokens.slice(k + 2, end).join(""));
      tex += close === "|" ? `\\sqrt{|${inner}|}` : `\\sqrt{${inner}}`;
      k = end;
    } else if (functions.has(token)) tex += `\\operatorname{${token}}`;
    else if (token === "+-") tex += "\\pm ";
    else if (token === "*") tex += "\\,";
    else if (token === "~") tex += "\\sim ";
    else if (token === "^" && tokens[k + 1] === "(") {
      const end = tokens.indexOf(")", k);
      tex += `^{${texOf(tokens.slice(k + 2, end).join(""))}}`;
      k = end;
    } else if (token === "^") tex += `^{${texOf(tokens[++k] ?? "")}}`;
    else if (plainWord) tex += `\\text{ ${token} }`;
    else if (/^[A-Za-z]\w*$/.test(token)) tex += symbol(token);
    else if (/^\s+$/.test(token)) tex += " ";
    else tex += token;
  }
  return tex;
}

export function Formula({ law }: { law: string }) {
  const place = useRef<HTMLSpanElement>(null);
  useEffect(() => {
    let wanted = true;
    const draw = async () => {
      const { default: katex } = await import("katex");  // as large as the rest of the page, which need not wait for it
      if (wanted && place.current) katex.render(texOf(law), place.current, { output: "mathml", throwOnError: true });
    };
    draw().catch(() => { if (wanted && place.current) place.current.textContent = law; });
    return () => { wanted = false; };
  }, [law]);
  return <span class="formula" ref={place} />;
}
