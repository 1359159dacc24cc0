// Short words for the document.

export const $ = (id) => document.getElementById(id);

export function make(name, properties, ...children) {
  const element = Object.assign(document.createElement(name), properties);
  element.append(...children);
  return element;
}

// What is said again is not read out again.
export function setText(element, text) {
  if (element.textContent !== text) element.textContent = text;
}
