// The theme's menus are labels of hidden check boxes, which a keyboard does not reach: make buttons of them. "/" goes to the search.
document.addEventListener("DOMContentLoaded", () => {
  for (const label of document.querySelectorAll("label[for^='__'], label[for^='toctree-checkbox']")) {
    if (label.classList.contains("overlay")) continue;
    label.tabIndex = 0;
    label.setAttribute("role", "button");
    if (!label.textContent.trim() && !label.hasAttribute("aria-label")) label.setAttribute("aria-label", "open or close this menu");
    label.addEventListener("keydown", (event) => {
      if (event.key !== "Enter" && event.key !== " ") return;
      event.preventDefault();
      label.click();
    });
  }
  for (const wide of document.querySelectorAll("pre, table.docutils")) {
    if (wide.scrollWidth > wide.clientWidth) wide.tabIndex = 0;  // so that arrow keys scroll it
  }
  document.addEventListener("keydown", (event) => {
    if (event.key === "Escape") for (const box of document.querySelectorAll("#__navigation, #__toc")) box.checked = false;
    const typing = /^(INPUT|TEXTAREA|SELECT)$/.test(event.target.tagName) || event.target.isContentEditable;
    if (event.key !== "/" || typing || event.ctrlKey || event.metaKey || event.altKey) return;
    const search = document.querySelector(".sidebar-search");
    if (!search) return;
    event.preventDefault();
    const navigation = document.querySelector("#__navigation");
    if (navigation) navigation.checked = true;
    search.focus();
  });
});
