"use strict";
// Filters the claims of a page, and lets the keyboard reach what is wider than the page; both work without it too.
(() => {
  const reach = () => {
    for (const box of document.querySelectorAll(".formula, .change dd")) {
      if (box.scrollWidth > box.clientWidth) box.tabIndex = 0; else box.removeAttribute("tabindex");
    }
  };
  window.addEventListener("resize", reach);
  document.addEventListener("toggle", reach, true);
  reach();
  // Paper cannot be scrolled: what is wider than a sheet is set smaller while it is printed.
  const sheet = 600;
  window.addEventListener("beforeprint", () => {
    for (const math of document.querySelectorAll(".formula math")) {
      const width = math.getBoundingClientRect().width;
      if (width > sheet) math.style.fontSize = `${Math.max(0.3, 0.85 * sheet / width)}rem`;
    }
  });
  window.addEventListener("afterprint", () => {
    for (const math of document.querySelectorAll(".formula math")) math.style.fontSize = "";
  });
  const form = document.querySelector("form.filters");
  if (!form) return;
  const claims = [...document.querySelectorAll("article.claim")];
  const words = new Map(claims.map((c) => [c, c.textContent.toLowerCase()]));
  const shown = form.querySelector(".shown");
  const apply = () => {
    const wanted = new Set([...form.querySelectorAll("[name=status]:checked")].map((box) => box.value));
    const text = form.elements.words.value.trim().toLowerCase();
    let count = 0;
    for (const claim of claims) {
      const fits = wanted.has(claim.dataset.status) && words.get(claim).includes(text);
      claim.hidden = !fits;
      count += fits;
    }
    shown.textContent = `${count} of ${claims.length} claims`;
  };
  form.addEventListener("input", apply);
  form.addEventListener("submit", (event) => event.preventDefault());
  const open = () => {
    const claim = document.getElementById(decodeURIComponent(location.hash.slice(1)));
    if (claim) { claim.hidden = false; claim.scrollIntoView(); }
  };
  window.addEventListener("hashchange", open);
  form.hidden = false;
  apply();
  open();
})();
