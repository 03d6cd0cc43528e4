(* Condition numbers by counting pivots: the kind `condition` of docs/certificates.md. *)

open Text
open Ball

let read_matrix value =
  let rows = List.map (fun row -> List.map (get_number "matrix") (get_list "matrix" row)) (get_list "matrix" value) in
  let n = match rows with row :: _ -> List.length row | [] -> refuse "matrix: expected a row" in
  if n < 1 || n > 200 || List.exists (fun row -> List.length row <> n) rows then refuse "matrix: expected rows of 1 to 200 numbers";
  Array.of_list (List.map Array.of_list rows)

(* N'N in rationals *)
let gram m =
  let n = Array.length m.(0) in
  let entry i j = Array.fold_left (fun sum row -> Q.add sum (Q.mul row.(i) row.(j))) Q.zero m in
  Array.init n (fun i -> Array.init n (entry i))

(* The number of positive pivots by Gauss without exchange of rows; all are seen to differ from 0. *)
let count_positive_pivots g =
  let n = Array.length g in
  let a = Array.map (Array.map of_rational) g in
  let count = ref 0 in
  for k = 0 to n - 1 do
    let pivot = a.(k).(k) in
    if has_zero pivot then refuse "condition: a pivot may be 0";
    if is_above pivot then incr count;
    for i = k + 1 to n - 1 do
      let c = over a.(i).(k) pivot in
      for j = k + 1 to n - 1 do a.(i).(j) <- less a.(i).(j) (times c a.(k).(j)) done
    done
  done;
  !count

(* N'N - q D, with D = 1 or the diagonal of N'N *)
let shifted g unit q =
  let diagonal i = if unit = 1 then g.(i).(i) else Q.one in
  Array.mapi (fun i row -> Array.mapi (fun j x -> if i = j then Q.sub x (Q.mul q (diagonal i)) else x) row) g

let check_brackets g unit (a, b, c, d) =
  let n = Array.length g in
  let count q = count_positive_pivots (shifted g unit q) in
  if not (count a > 0 && count b = 0) then refuse "the largest singular value is not enclosed";
  if not (Q.sign c > 0 && Q.sign d > 0 && count c = n && count d < n) then refuse "the smallest singular value is not enclosed"

let check value ~at_precision =
  match get_keys "condition" [ "kind"; "statement"; "outside"; "brackets"; "bits" ] value with
  | [ _; statement; outside; brackets; bits ] -> (
      let bits = get_integer "bits" 53 20000 bits and outside = get_integer "outside" 0 1 outside = 1 in
      match (get_keys "statement" [ "matrix"; "unit"; "lower"; "upper" ] statement, get_list "brackets" brackets) with
      | [ matrix; unit; lower; upper ], [ a; b; c; d ] ->
          let number = get_number "brackets" in
          let a, b, c, d = (number a, number b, number c, number d) in
          let lower = get_number "lower" lower and upper = get_number "upper" upper in
          if Q.sign lower < 0 || Q.gt lower upper then refuse "expected 0 <= lower <= upper";
          let g = gram (read_matrix matrix) and unit = get_integer "unit" 0 1 unit in
          at_precision bits (fun () -> check_brackets g unit (a, b, c, d));
          let low = Q.div a d and high = Q.div b c in
          let lower = Q.mul lower lower and upper = Q.mul upper upper in
          let shown =
            if outside then Q.lt high lower || Q.lt upper low
            else Q.leq lower (Q.max low Q.one) && Q.leq high upper
          in
          if not shown then refuse "the condition number is not shown to lie there"
      | _ -> refuse "brackets: expected four numbers")
  | _ -> assert false
