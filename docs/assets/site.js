/* Draws the formulas of a page; without KaTeX they stay as TeX. */
document.addEventListener("DOMContentLoaded", () => {
    if (!window.katex) return;
    document.querySelectorAll(".math").forEach((e) => {
        katex.render(e.textContent, e, {displayMode: e.tagName === "DIV", throwOnError: false});
    });
});
