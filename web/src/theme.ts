export type Theme = "auto" | "light" | "dark";

export function firstTheme(): Theme {
  const kept = localStorage.getItem("theme");
  return kept === "light" || kept === "dark" ? kept : "auto";
}

const system = matchMedia("(prefers-color-scheme: dark)");

export function applyTheme(theme: Theme): () => void {
  const apply = () => {
    document.documentElement.dataset.theme = theme === "auto" ? (system.matches ? "dark" : "light") : theme;
    dispatchEvent(new Event("themechange"));
  };
  localStorage.setItem("theme", theme);
  apply();
  system.addEventListener("change", apply);
  return () => system.removeEventListener("change", apply);
}
